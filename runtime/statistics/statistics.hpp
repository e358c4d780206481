#pragma once
// How good a fit is, whether a residual holds more than noise, and how sure one may be of it.
#include "record/autoregression.hpp"
#include "record/random.hpp"
#include "statistics/bootstrap.hpp"
#include "statistics/correlation.hpp"
#include "statistics/distributions.hpp"
#include "statistics/fit_measures.hpp"
#include "statistics/residual_tests.hpp"
