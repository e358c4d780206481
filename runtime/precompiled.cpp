#define LUNID_INSTANCE template
#include "precompiled.hpp"
