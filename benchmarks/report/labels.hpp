// SPDX-License-Identifier: BSD-2-Clause
// Places text in a picture so that no text is cut off and no two texts overlap.
#pragma once

#include <string>
#include <vector>

namespace dyn::benchmark {

/// Approximate width of `text` in sans-serif letters of font size `size`.
double textWidth(const std::string& text, double size);

/// Breaks `text` between words into lines that are at most `width` wide. A longer word gets a line of its own.
std::vector<std::string> wrapped(const std::string& text, double size, double width);

/// Returns numbers near the wanted ones, at least `apart` from each other and within [low, high] if there is room.
std::vector<double> spread(const std::vector<double>& wanted, double apart, double low, double high);

struct Box {
  double x, y, width, height;
};

/// A frame in the picture, and the boxes in it that are already taken.
class FreeSpace {
 public:
  explicit FreeSpace(const Box& frame) : frame_(frame) {}
  /// Takes the first of `places` that is free and within the frame. Returns its index, or -1 if there is none.
  int takeFirst(const std::vector<Box>& places);

 private:
  Box frame_;
  std::vector<Box> taken_;
};

}  // namespace dyn::benchmark
