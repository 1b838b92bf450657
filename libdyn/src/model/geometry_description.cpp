// SPDX-License-Identifier: BSD-2-Clause
#include <dyn/model/geometry_description.hpp>

namespace dyn {

geometry::TriangleMesh heightField(int rows, int columns, const std::vector<double>& heights, double x0, double y0, double dx, double dy) {
  if (rows < 2 || columns < 2 || heights.size() != static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns))
    throw Error(ErrorCode::size, "a height field of " + std::to_string(rows) + " x " + std::to_string(columns) + " was given " +
                                     std::to_string(heights.size()) + " heights; it needs one a point, and two rows and columns at least");
  geometry::TriangleMesh mesh;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) mesh.vertices.push_back({x0 + i * dx, y0 + j * dy, heights[mesh.vertices.size()]});
  for (int i = 0; i + 1 < rows; ++i) {
    for (int j = 0; j + 1 < columns; ++j) {
      const int a = i * columns + j, b = a + columns;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  }
  return mesh;
}

}  // namespace dyn
