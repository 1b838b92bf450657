// SPDX-License-Identifier: BSD-2-Clause
// Functions that tell a simulation what touches.
#include "callbacks.hpp"

#include <dyn/geometry/contact_finder.hpp>
#include <dyn/spatial/eigen.hpp>

#include <pybind11/stl.h>

#include <memory>
#include <mutex>

namespace dyn::python {

namespace {

using Vector3 = Eigen::Vector3d;
using Frictions = std::vector<std::tuple<std::string, std::string, double>>;

/// Makes a finder of a Python function.
ContactFinder finderOf(const py::function& function) {
  return {[function](const VectorResult& q, double reach, std::vector<ContactPoint>& found) {
            runPython([&] {
              const py::object list = function(Eigen::VectorXd(q), reach);
              const auto points = returned<std::vector<ContactPoint>>(list, "the finder of contacts", "a list of ContactPoint");
              found.insert(found.end(), points.begin(), points.end());
            });
          },
          nullptr};
}

/// Lets one thread at a time use a finder, whose copies share memory. Simulations run without the interpreter's lock.
ContactFinder serialized(const ContactFinder& finder) {
  const auto mutex = std::make_shared<std::mutex>();
  const auto find = [finder, mutex](const VectorResult& q, double reach, std::vector<ContactPoint>& found) {
    const std::lock_guard lock(*mutex);
    finder(q, found, reach);
  };
  const auto look = [finder, mutex](const VectorResult& q, const MatrixResult& velocities, double seconds) {
    const std::lock_guard lock(*mutex);
    return finder.approach(q, velocities, seconds);
  };
  return {find, look};
}

}  // namespace

void addContactFinders(py::module_& m) {
  py::class_<ContactPoint>(m, "ContactPoint", "A point of one body near the surface of another.")
      .def(py::init([](std::int64_t id, int frame, const Vector3& point, int other, const Vector3& normal, double gap, double friction) {
             return ContactPoint{id, frame, fromEigen3(point), other, fromEigen3(normal), gap, friction};
           }),
           py::arg("id"), py::arg("frame"), py::arg("point") = Vector3::Zero().eval(), py::arg("other") = 0,
           py::arg("normal") = Vector3::UnitZ().eval(), py::arg("gap") = 0.0, py::arg("friction") = 0.0)
      .def_readonly("id", &ContactPoint::id, "Not negative; in every call the same for the same place on the two surfaces.")
      .def_readonly("frame", &ContactPoint::frame, "The index of the point's frame.")
      .def_property_readonly(
          "point", [](const ContactPoint& x) { return toEigen(x.point); }, "In that frame [m].")
      .def_readonly("other", &ContactPoint::other, "The index of the surface's frame; 0: the world.")
      .def_property_readonly(
          "normal", [](const ContactPoint& x) { return toEigen(x.normal); }, "Of the surface, away from it, in the axes of `other`.")
      .def_readonly("gap", &ContactPoint::gap, "[m] between point and surface; negative inside.")
      .def_readonly("friction", &ContactPoint::friction, "The coefficient.");
  py::class_<ContactFinder>(
      m, "ContactFinder",
      "Tells a simulation what touches. Each simulation should have its own; those that share one wait for each other.\n\n"
      "find(q, reach) returns a list of ContactPoint, a function of q alone; points farther away than `reach` [m] may be missing.\n"
      "Finders written in Python do not look ahead: fast bodies may pass through thin ones.")
      .def(py::init(&finderOf), py::arg("find"))
      .def(
          "__call__",
          [](const ContactFinder& finder, const Eigen::VectorXd& q, double reach) {
            std::vector<ContactPoint> found;
            withPythonExceptions([&] {
              const py::gil_scoped_release unlocked;
              finder({q.data(), q.size()}, found, reach);
            });
            return found;
          },
          py::arg("q"), py::arg("reach") = 0.0, "Returns the contact points at q (nq,).")
      .def_property_readonly("looks_ahead", &ContactFinder::looksAhead, "Whether it says for how long nothing can touch.");
  m.def("together", &together, py::arg("a"), py::arg("b"), "Makes a finder that reports the contacts of both.");
  const GeometryContactOptions standard;
  m.def(
      "geometry_contacts",
      [](const CompactModel& model, const GeometryModel& geometry, double friction, double margin, const Frictions& pairs) {
        GeometryContactOptions options{friction, {}, margin};
        for (const auto& [a, b, own] : pairs) options.pairs.push_back({{a, b}, own});
        return serialized(geometryContacts(model, geometry, options));
      },
      py::arg("model"), py::arg("geometry"), py::arg("friction") = standard.friction, py::arg("margin") = standard.margin,
      py::arg("pairs") = Frictions(),
      "Makes a finder of the contacts of all pairs.\n\n"
      "friction: the coefficient. margin: volumes farther apart [m] are reported only if they may meet within the step. pairs: (a, b, friction) for\n"
      "single pairs of volumes or bodies; later entries win.");
  m.def(
      "points_on_plane",
      [](const CompactModel& model, const std::vector<std::string>& frames, const Vector3& normal, double height, double friction) {
        return serialized(pointsOnPlane(model, frames, fromEigen3(normal), height, friction));
      },
      py::arg("model"), py::arg("frames"), py::arg("normal") = Vector3::UnitZ().eval(), py::arg("height") = 0.0, py::arg("friction") = 0.0,
      "Makes a finder of contacts between origins of frames and the plane normal . x = height [m], in world axes.");
}

}  // namespace dyn::python
