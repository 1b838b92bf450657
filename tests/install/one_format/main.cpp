// SPDX-License-Identifier: BSD-2-Clause
// A program that reads URDF and no other format.
#include <dyn/parsers/urdf.hpp>

#include <cstdio>

int main(int, char** argv) {
  const dyn::Model model = dyn::urdf::load(argv[1]);
  std::printf("%s has %zu bodies\n", model.name.c_str(), model.bodies.size() - 1);
  return model.bodies.size() > 1 ? 0 : 1;
}
