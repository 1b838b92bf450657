// SPDX-License-Identifier: BSD-2-Clause
// The random numbers and the digest of sweeps, against published values.
#include "support/catch.hpp"

#include <sweep/random.hpp>
#include <sweep/sha256.hpp>

#include <cmath>

using namespace dyn::tool::sweep;

TEST_CASE("Philox 4x32-10 has the values that its authors published", "[sweep]") {
  // Known answers of Random123 1.09.
  CHECK(philox({0, 0, 0, 0}, {0, 0}) == PhiloxCounter{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8});
  CHECK(philox({~0u, ~0u, ~0u, ~0u}, {~0u, ~0u}) == PhiloxCounter{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd});
  CHECK(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}) ==
        PhiloxCounter{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1});
}

TEST_CASE("uniform and normal numbers of samples have the moments of their distributions", "[sweep]") {
  constexpr int n = 100000;
  double mean = 0, square = 0, normal_mean = 0, normal_square = 0, product = 0;
  for (std::uint64_t k = 0; k < n; ++k) {
    const RandomNumbers q(7, k, "q"), v(7, k, "v");
    const double u = q.uniform(0), z = q.normal(1);
    REQUIRE((u >= 0 && u < 1 && std::isfinite(z)));
    mean += u, square += u * u, normal_mean += z, normal_square += z * z;
    product += (u - 0.5) * (v.uniform(0) - 0.5);
  }
  // Four standard errors.
  CHECK(std::abs(mean / n - 0.5) < 4 * std::sqrt(1.0 / 12 / n));
  CHECK(std::abs(square / n - 1.0 / 3) < 4 * std::sqrt(4.0 / 45 / n));
  CHECK(std::abs(normal_mean / n) < 4 * std::sqrt(1.0 / n));
  CHECK(std::abs(normal_square / n - 1) < 4 * std::sqrt(2.0 / n));
  CHECK(std::abs(product / n) < 4 / 12.0 / std::sqrt(n));
}

TEST_CASE("samples, quantities, entries and seeds have numbers of their own", "[sweep]") {
  const double x = RandomNumbers(1, 2, "q").uniform(3);
  CHECK(x == RandomNumbers(1, 2, "q").uniform(3));
  CHECK(x != RandomNumbers(1, 2, "q").uniform(4));
  CHECK(x != RandomNumbers(1, 2, "v").uniform(3));
  CHECK(x != RandomNumbers(1, 3, "q").uniform(3));
  CHECK(x != RandomNumbers(2, 2, "q").uniform(3));
  CHECK(x != RandomNumbers(1, 2 + (std::uint64_t{1} << 32), "q").uniform(3));
  CHECK(x != RandomNumbers(1 + (std::uint64_t{1} << 32), 2, "q").uniform(3));
}

TEST_CASE("SHA-256 has the values of FIPS 180-4, however its text is cut", "[sweep]") {
  CHECK(sha256("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  CHECK(sha256("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  CHECK(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq") == "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  const std::string million(1000000, 'a');
  CHECK(sha256(million) == "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  Sha256 parts;
  for (std::size_t at = 0, part = 1; at < million.size(); at += part, part = part % 131 + 1) parts.add(std::string_view(million).substr(at, part));
  CHECK(parts.digest() == sha256(million));
}
