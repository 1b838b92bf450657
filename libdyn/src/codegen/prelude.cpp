// SPDX-License-Identifier: BSD-2-Clause
#include "codegen/prelude.hpp"

namespace dyn {

namespace {

/// Reduction modulo pi / 2 and series as in dyn_sdk/sincos.hpp, written for vectors. Angles that are too large, or too near a multiple of pi / 2, for
/// the digits of DYN_PART1 to DYN_PART3 go to the C library.
constexpr const char* sincos_double = R"(#define DYN_LIMIT 1e6
#define DYN_LEAST 0x1p-30
#define DYN_ROUND 0x1.8p52
#define DYN_PART1 0x1.921fb544p+0
#define DYN_PART2 0x1.0b4611a6p-34
#define DYN_PART3 0x1.3198a2e037073p-69
#define DYN_SIN(z) (z * DYN_SIN1(z * z) + DYN_SIN0(z * z))
#define DYN_SIN1(y) (((y * 0x1.952c77030ad4ap-49 + 0x1.6124613a86d09p-33) * y + 0x1.71de3a556c734p-19) * y + 0x1.1111111111111p-7)
#define DYN_SIN0(y) (((y * -0x1.ae7f3e733b81fp-41 - 0x1.ae64567f544e4p-26) * y - 0x1.a01a01a01a01ap-13) * y - 0x1.5555555555555p-3)
#define DYN_COS(z) (z * DYN_COS1(z * z) + DYN_COS0(z * z))
#define DYN_COS1(y) ((y * -0x1.93974a8c07c9dp-37 - 0x1.27e4fb7789f5cp-22) * y - 0x1.6c16c16c16c17p-10)
#define DYN_COS0(y) (((y * 0x1.ae7f3e733b81fp-45 + 0x1.1eed8eff8d898p-29) * y + 0x1.a01a01a01a01ap-16) * y + 0x1.5555555555555p-5)
)";
constexpr const char* sincos_float = R"(#define DYN_LIMIT 4000.0f
#define DYN_LEAST 0x1p-11f
#define DYN_ROUND 0x1.8p23f
#define DYN_PART1 0x1.92p+0f
#define DYN_PART2 0x1.fb4p-12f
#define DYN_PART3 0x1.4442d2p-24f
#define DYN_SIN(z) (((z * 0x1.71de3ap-19f - 0x1.a01a02p-13f) * z + 0x1.111112p-7f) * z - 0x1.555556p-3f)
#define DYN_COS(z) (((z * -0x1.27e4fcp-22f + 0x1.a01a02p-16f) * z - 0x1.6c16c2p-10f) * z + 0x1.555556p-5f)
)";

/// The number type's math functions, the wider type for angles that go to the C library, and the vector width (64 bytes).
constexpr const char* double_type = R"(#define R(x) x
#define DYN_LIBM(name) name
#define DYN_WIDER(name) name##l
#define DYN_FABS fabs
#define DYN_WIDTH 8
#define DYN_DIGITS 0x7fffffffffffffffLL
typedef long long dyn_int;
typedef long double dyn_wider;
)";
constexpr const char* float_type = R"(#define R(x) x##f
#define DYN_LIBM(name) name##f
#define DYN_WIDER(name) name
#define DYN_FABS fabsf
#define DYN_WIDTH 16
#define DYN_DIGITS 0x7fffffff
typedef int dyn_int;
typedef double dyn_wider;
)";

/// Sines and cosines of whole vectors of DYN_WIDTH numbers where the compiler has vector types, of single numbers elsewhere.
constexpr const char* sincos_loop = R"(
#if defined(__GNUC__)
/* Vectors are passed between functions of this file only. */
#pragma GCC diagnostic ignored "-Wpsabi"
typedef dyn_real V __attribute__((vector_size(DYN_WIDTH * sizeof(dyn_real)), aligned(sizeof(dyn_real)), may_alias));
typedef dyn_int M __attribute__((vector_size(DYN_WIDTH * sizeof(dyn_int)), may_alias));
#define DYN_BLEND(m, x, y) ((V)(((m) & (M)(x)) | (~(m) & (M)(y))))
#define DYN_SIZE(x) ((V)((M)(x) & DYN_DIGITS))
#define DYN_LANE(m, l) m[l]
#else
typedef dyn_real V;
typedef int M;
#undef DYN_WIDTH
#define DYN_WIDTH 1
#define DYN_BLEND(m, x, y) ((m) ? (x) : (y))
#define DYN_SIZE DYN_FABS
#define DYN_LANE(m, l) m
#endif

/* Of DYN_WIDTH numbers. From registers: what was written to memory one by one is not soon read as a whole. */
static inline void dyn_sincos_vector(V x, dyn_real* sine, dyn_real* cosine) {
  int l;
  const V k = (x * R(0.63661977236758134308) + DYN_ROUND) - DYN_ROUND;
  const V a = x - k * DYN_PART1, b = k * DYN_PART2, r0 = a - b, e0 = ((a - r0) - b) - k * DYN_PART3;
  const V r = r0 + e0, e = (r0 - r) + e0, z = r * r, half = R(0.5) * z, top = R(1.0) - half;
  const V sr = r + (r * z * (DYN_SIN(z)) + e * top);
  const V cr = top + (((R(1.0) - top) - half) + (z * z * (DYN_COS(z)) - r * e));
  const V quarter = k - R(4.0) * ((k * R(0.25) - R(0.375) + DYN_ROUND) - DYN_ROUND);
  const M odd = (M)(DYN_SIZE(quarter - R(2.0)) == R(1.0));
  const V s = DYN_BLEND(odd, cr, sr), c = DYN_BLEND(odd, sr, cr);
  *(V*)sine = DYN_BLEND((M)(quarter >= R(1.5)), -s, s);
  *(V*)cosine = DYN_BLEND((M)(DYN_SIZE(quarter - R(1.5)) < R(1.0)), -c, c);
  const M beyond = (M)(DYN_SIZE(k) >= DYN_LIMIT) | ((M)(DYN_SIZE(r) <= DYN_LEAST) & (M)(DYN_SIZE(k) >= R(0.5))) | (M)(x != x);
  dyn_int any = 0;
  for (l = 0; l < DYN_WIDTH; ++l) any |= DYN_LANE(beyond, l);
  if (!any) return;
  for (l = 0; l < DYN_WIDTH; ++l) {
    if (!DYN_LANE(beyond, l)) continue;
    sine[l] = (dyn_real)DYN_WIDER(sin)((dyn_wider)DYN_LANE(x, l));
    cosine[l] = (dyn_real)DYN_WIDER(cos)((dyn_wider)DYN_LANE(x, l));
  }
}

)";

constexpr const char* scalar_functions = R"(typedef dyn_real T;
#define DYN_ALL(x) (x)
#define dyn_sqrt DYN_LIBM(sqrt)
#define dyn_sin DYN_LIBM(sin)
#define dyn_cos DYN_LIBM(cos)
#define dyn_tan DYN_LIBM(tan)
#define dyn_exp DYN_LIBM(exp)
#define dyn_log DYN_LIBM(log)
#define dyn_atan2 DYN_LIBM(atan2)
#define dyn_abs DYN_FABS
#define dyn_select_less(a, b, c, d) ((a) < (b) ? (c) : (d))
#if defined(__GNUC__)
typedef dyn_real dyn_four __attribute__((vector_size(4 * sizeof(dyn_real)), aligned(sizeof(dyn_real)), may_alias));
#endif

)";

constexpr const char* vector_functions = R"(typedef dyn_real T __attribute__((vector_size(DYN_LANES * sizeof(dyn_real)), aligned(sizeof(dyn_real))));
#define DYN_ALL(x) ((T){0} + (x))
#define DYN_EACH(name, f) static inline T name(T x) { T y; int i; for (i = 0; i < DYN_LANES; ++i) y[i] = f(x[i]); return y; }
DYN_EACH(dyn_sqrt, DYN_LIBM(sqrt))
DYN_EACH(dyn_tan, DYN_LIBM(tan))
DYN_EACH(dyn_exp, DYN_LIBM(exp))
DYN_EACH(dyn_log, DYN_LIBM(log))
DYN_EACH(dyn_abs, DYN_FABS)
static inline T dyn_atan2(T y, T x) { T z; int i; for (i = 0; i < DYN_LANES; ++i) z[i] = DYN_LIBM(atan2)(y[i], x[i]); return z; }
DYN_EACH(dyn_sin, DYN_LIBM(sin))
DYN_EACH(dyn_cos, DYN_LIBM(cos))
static inline T dyn_select_less_(T a, T b, T c, T d) { T y; int i; for (i = 0; i < DYN_LANES; ++i) y[i] = a[i] < b[i] ? c[i] : d[i]; return y; }
#define dyn_select_less(a, b, c, d) dyn_select_less_(DYN_ALL(a), DYN_ALL(b), DYN_ALL(c), DYN_ALL(d))
static inline void dyn_sincos(const T* angle, T* sine, T* cosine, int n) {
  int i;
  for (i = 0; i < n * DYN_LANES; i += DYN_WIDTH)
    dyn_sincos_vector(*(const V*)((const dyn_real*)angle + i), (dyn_real*)sine + i, (dyn_real*)cosine + i);
}

)";

}  // namespace

std::string codegenPrelude(bool single, int lanes) {
  std::string out = "#include <math.h>\n\n";
  out +=
      "#if defined(__GNUC__)\n#define DYN_PIECE __attribute__((noinline, unused))\n#define DYN_ALIGNED __attribute__((aligned(64)))\n#else\n#define "
      "DYN_PIECE\n"
      "#define DYN_ALIGNED\n#endif\n";
  out += single ? float_type : double_type;
  out += single ? sincos_float : sincos_double;
  out += sincos_loop;
  if (lanes == 1) return out + scalar_functions;
  return out + "#define DYN_LANES " + std::to_string(lanes) + "\n" + vector_functions;
}

}  // namespace dyn
