// The only thing that links MPI.
#include <mpi.h>

#include <vector>

#include "../ranks.hpp"

namespace {

int ranks = 1, own = 0;

int start(int* rank, int* size) {
  int provided = 0;
  // threads run members; only the main one speaks with other ranks
  if (const int code = MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided)) return code;
  if (const int code = MPI_Comm_rank(MPI_COMM_WORLD, &own)) return code;
  if (const int code = MPI_Comm_size(MPI_COMM_WORLD, &ranks)) return code;
  *rank = own;
  *size = ranks;
  return 0;
}

int gather_sizes(long mine, long* sizes) {
  return MPI_Allgather(&mine, 1, MPI_LONG, sizes, 1, MPI_LONG, MPI_COMM_WORLD);
}

int gather(const char* mine, const long* sizes, char* all) {
  std::vector<int> counts, places;
  int at = 0;
  for (int r = 0; r < ranks; ++r) {
    counts.push_back(static_cast<int>(sizes[r]));
    places.push_back(at);
    at += counts.back();
  }
  return MPI_Allgatherv(mine, counts[static_cast<std::size_t>(own)], MPI_CHAR, all, counts.data(), places.data(),
                        MPI_CHAR, MPI_COMM_WORLD);
}

void abort_all(int code) { MPI_Abort(MPI_COMM_WORLD, code); }

int finish() { return MPI_Finalize(); }

}  // namespace

extern "C" __attribute__((visibility("default")))
const lunid::lua::RanksModule lunid_ranks{lunid::lua::ranks_version, start, gather_sizes, gather, abort_all, finish};
