#pragma once
// The treatments of treat.hpp on streams, block by block: memory does not grow with the rows. Trends, rates and
// integrals rid of a polynomial give the numbers of the whole record but for rounding (1e-11 of a deviation), filters
// to 1e-9; of several treatments one after another, what lies at the ends of the record (where it is continued) to
// 1e-4. Each looks through the rows once when it is made, an integral with a high pass up to four times. A stream in
// memory is treated as its record. Errors are those of the whole record.
#include "record/stream.hpp"
#include "record/treat.hpp"

namespace lunid {

/// Throws InputError also where the filter reaches over more than 262144 rows on either side: a cut-off that is low for
/// the rate.
Stream filter(const Stream& stream, const FilterOptions& options);
Stream detrend(const Stream& stream, int degree, const std::vector<std::string>& channels);
Stream decimate(const Stream& stream, int factor);
Stream resample(const Stream& stream, double rate);
Stream integrate(const Stream& stream, const IntegrateOptions& options);

}  // namespace lunid
