// Where words go in a picture, so that none is cut off and none lies over another.
#pragma once

#include <string>
#include <vector>

namespace dyn::benchmark {

/// By and large, of sans-serif letters of this size.
double textWidth(const std::string& text, double size);

/// Its words in lines that are no wider.
std::vector<std::string> wrapped(const std::string& text, double size, double width);

/// Numbers near those that are wanted, at least `apart` from each other and within [low, high] if there is room.
std::vector<double> spread(const std::vector<double>& wanted, double apart, double low, double high);

struct Box {
  double x, y, width, height;
};

/// A part of the picture, and what is taken of it.
class FreeSpace {
 public:
  explicit FreeSpace(const Box& frame) : frame_(frame) {}
  /// Takes the first of these places that is free and within the frame; its number, -1 if none is.
  int takeFirst(const std::vector<Box>& places);

 private:
  Box frame_;
  std::vector<Box> taken_;
};

}  // namespace dyn::benchmark
