#pragma once
// Counts what a test executable takes from the heap (simulate_allocations_test.cpp replaces operator new).

namespace lunid::testing {

/// Calls of operator new so far, by all threads.
long allocations();

}  // namespace lunid::testing
