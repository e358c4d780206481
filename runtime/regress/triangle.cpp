#include "regress/triangle.hpp"

#include <cmath>
#include <cstring>

namespace lunid {
namespace {

constexpr int kPanel = 4;  // reflectors applied together
constexpr int kLanes = 4;  // logical lanes: the order of every sum, on every machine
using Index = Eigen::Index;
using Pair [[gnu::vector_size(16)]] = double;  // SSE2
using Quad [[gnu::vector_size(32)]] = double;  // AVX2

#define LUNID_INLINE [[gnu::always_inline]] static inline

/// Four logical lanes held in machine vectors of type V.
template <class V>
struct Four {
  static constexpr int width = sizeof(V) / sizeof(double), count = kLanes / width;
  V part[count];
};
template <class V>
LUNID_INLINE void load(Four<V>& x, const double* p) {
  for (int i = 0; i < Four<V>::count; ++i) std::memcpy(&x.part[i], p + i * Four<V>::width, sizeof(V));
}
template <class V>
LUNID_INLINE void store(const Four<V>& x, double* p) {
  for (int i = 0; i < Four<V>::count; ++i) std::memcpy(p + i * Four<V>::width, &x.part[i], sizeof(V));
}
/// sum += a * b, two roundings
template <class V>
LUNID_INLINE void accumulate(Four<V>& sum, const Four<V>& a, const Four<V>& b) {
  for (int i = 0; i < Four<V>::count; ++i) sum.part[i] += a.part[i] * b.part[i];
}
/// x -= w * a
template <class V>
LUNID_INLINE void reduce(Four<V>& x, double w, const Four<V>& a) {
  for (int i = 0; i < Four<V>::count; ++i) x.part[i] -= w * a.part[i];
}
template <class V>
LUNID_INLINE double total(const Four<V>& x) {
  double lane[kLanes];
  store(x, lane);
  return (lane[0] + lane[2]) + (lane[1] + lane[3]);
}

template <class V>
LUNID_INLINE double dot(const double* a, const double* b, Index m) {
  Four<V> sum = {}, x, y;
  Index i = 0;
  for (; i + kLanes <= m; i += kLanes) {
    load(x, a + i);
    load(y, b + i);
    accumulate(sum, x, y);
  }
  double rest = 0;
  for (; i < m; ++i) rest += a[i] * b[i];
  return rest + total(sum);
}

/// b -= w v
template <class V>
LUNID_INLINE void subtract(double* b, double w, const double* v, Index m) {
  Four<V> x, y;
  Index i = 0;
  for (; i + kLanes <= m; i += kLanes) {
    load(x, b + i);
    load(y, v + i);
    reduce(x, w, y);
    store(x, b + i);
  }
  for (; i < m; ++i) b[i] -= w * v[i];
}

/// w[q][c] = v_q . b_c for the four reflectors of a panel and C columns.
template <class V, int C>
LUNID_INLINE void panel_dots(const double* const* v, double* const* b, Index m, double (*w)[C]) {
  Four<V> sum[kPanel][C] = {}, x, y[C];
  Index i = 0;
  for (; i + kLanes <= m; i += kLanes) {
    for (int c = 0; c < C; ++c) load(y[c], b[c] + i);
    for (int q = 0; q < kPanel; ++q) {
      load(x, v[q] + i);
      for (int c = 0; c < C; ++c) accumulate(sum[q][c], x, y[c]);
    }
  }
  for (int q = 0; q < kPanel; ++q)
    for (int c = 0; c < C; ++c) {
      double rest = 0;
      for (Index k = i; k < m; ++k) rest += v[q][k] * b[c][k];
      w[q][c] = rest + total(sum[q][c]);
    }
}

/// b_c -= sum_q w[q][c] v_q
template <class V, int C>
LUNID_INLINE void panel_subtract(const double* const* v, double* const* b, Index m, const double (*w)[C]) {
  Four<V> x, y[C];
  Index i = 0;
  for (; i + kLanes <= m; i += kLanes) {
    for (int c = 0; c < C; ++c) load(y[c], b[c] + i);
    for (int q = 0; q < kPanel; ++q) {
      load(x, v[q] + i);
      for (int c = 0; c < C; ++c) reduce(y[c], w[q][c], x);
    }
    for (int c = 0; c < C; ++c) store(y[c], b[c] + i);
  }
  for (; i < m; ++i)
    for (int c = 0; c < C; ++c)
      for (int q = 0; q < kPanel; ++q) b[c][i] -= w[q][c] * v[q][i];
}

/// The problem in raw form: upper triangle r (stride ldr) over block b (m rows, stride ldb), k columns.
struct Stack {
  double *r, *b;
  Index ldr, ldb, m, k;
  double* column(Index j) const { return b + j * ldb; }
  double& head(Index i, Index j) const { return r[i + j * ldr]; }
};

/// Reflector that zeroes column j of the block; v replaces the column (its head is 1). Returns tau, 0 when nothing is
/// to do.
template <class V>
LUNID_INLINE double reflector(const Stack& s, Index j) {
  double* v = s.column(j);
  const double below = dot<V>(v, v, s.m);
  if (below == 0) return 0;
  double& alpha = s.head(j, j);
  const double beta = -std::copysign(std::sqrt(alpha * alpha + below), alpha);
  const double scale = 1 / (alpha - beta), tau = (beta - alpha) / beta;
  for (Index i = 0; i < s.m; ++i) v[i] *= scale;
  alpha = beta;
  return tau;
}

template <class V>
LUNID_INLINE void apply_one(const Stack& s, Index j, double tau, Index column) {
  double& top = s.head(j, column);
  double* b = s.column(column);
  const double w = tau * (top + dot<V>(s.column(j), b, s.m));
  top -= w;
  subtract<V>(b, w, s.column(j), s.m);
}

/// H' b for the panel's H = I - V T V', C columns from `first` on.
template <class V, int C>
LUNID_INLINE void apply_panel(const Stack& s, Index j, const double (&t)[kPanel][kPanel], Index first) {
  const double* v[kPanel];
  double* b[C];
  double dots[kPanel][C], w[kPanel][C];
  for (int q = 0; q < kPanel; ++q) v[q] = s.column(j + q);
  for (int c = 0; c < C; ++c) b[c] = s.column(first + c);
  panel_dots<V, C>(v, b, s.m, dots);
  for (int c = 0; c < C; ++c) {
    for (int q = 0; q < kPanel; ++q) dots[q][c] += s.head(j + q, first + c);
    for (int q = 0; q < kPanel; ++q) {
      w[q][c] = 0;
      for (int p = 0; p <= q; ++p) w[q][c] += t[p][q] * dots[p][c];
      s.head(j + q, first + c) -= w[q][c];
    }
  }
  panel_subtract<V, C>(v, b, s.m, w);
}

template <class V, int C>
LUNID_INLINE void eliminate(const Stack& s) {
  Index j = 0;
  for (; j + kPanel < s.k; j += kPanel) {
    double t[kPanel][kPanel] = {};
    for (int q = 0; q < kPanel; ++q) {
      t[q][q] = reflector<V>(s, j + q);
      for (int c = q + 1; c < kPanel; ++c) apply_one<V>(s, j + q, t[q][q], j + c);
    }
    for (int q = 1; q < kPanel; ++q) {
      double dots[kPanel];
      for (int p = 0; p < q; ++p) dots[p] = dot<V>(s.column(j + p), s.column(j + q), s.m);
      for (int p = 0; p < q; ++p) {
        double sum = 0;
        for (int i = p; i < q; ++i) sum += t[p][i] * dots[i];
        t[p][q] = -t[q][q] * sum;
      }
    }
    Index column = j + kPanel;
    for (; column + C <= s.k; column += C) apply_panel<V, C>(s, j, t, column);
    for (; column < s.k; ++column) apply_panel<V, 1>(s, j, t, column);
  }
  for (; j < s.k; ++j) {
    const double tau = reflector<V>(s, j);
    for (Index column = j + 1; column < s.k; ++column) apply_one<V>(s, j, tau, column);
  }
}

// As many columns at once as the registers hold; the order of each sum is the same in both.
#if defined(__x86_64__)
[[gnu::target("avx2")]] void eliminate_wide(const Stack& s) { eliminate<Quad, 2>(s); }
bool wide() { return __builtin_cpu_supports("avx2"); }
#else
void eliminate_wide(const Stack& s) { eliminate<Pair, 1>(s); }
bool wide() { return false; }
#endif
void eliminate_narrow(const Stack& s) { eliminate<Pair, 1>(s); }

}  // namespace

void triangularise(Eigen::Ref<Eigen::MatrixXd> r, Eigen::Ref<Eigen::MatrixXd> block) {
  eigen_assert(r.rows() == r.cols() && r.cols() == block.cols());
  if (block.rows() == 0 || r.cols() == 0) return;
  const Stack stack{r.data(), block.data(), r.outerStride(), block.outerStride(), block.rows(), r.cols()};
  wide() ? eliminate_wide(stack) : eliminate_narrow(stack);
}

void triangularise(LongMatrix& r, LongMatrix block) {
  eigen_assert(r.rows() == r.cols() && r.cols() == block.cols());
  for (Index j = 0; j < r.cols(); ++j) {
    Index rows = block.rows();
    while (rows > 0 && block(rows - 1, j) == 0) --rows;
    if (rows == 0) continue;
    auto v = block.col(j).head(rows);
    const long double alpha = r(j, j), norm = std::sqrt(alpha * alpha + v.squaredNorm());
    const long double beta = std::signbit(alpha) ? norm : -norm, tau = (beta - alpha) / beta;
    v /= alpha - beta;
    r(j, j) = beta;
    for (Index l = j + 1; l < r.cols(); ++l) {
      const long double w = tau * (r(j, l) + v.dot(block.col(l).head(rows)));
      r(j, l) -= w;
      block.col(l).head(rows) -= w * v;
    }
  }
}

}  // namespace lunid
