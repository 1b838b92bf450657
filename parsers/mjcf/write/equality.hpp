// SPDX-License-Identifier: BSD-2-Clause
// Constraints and dependent joints as <equality>, with the sites that they tie.
#pragma once

#include "joints.hpp"

namespace dyn::mjcf {

/// A named place on a body.
struct Site {
  std::string name;
  SE3<double> pose;  ///< in the body's frame
};

class EqualityWriter {
 public:
  /// Finds the frames that constraints name, and makes sites where there are none. `names` are those of the model's bodies and frames.
  EqualityWriter(const Model& model, xml::Output& out, std::set<std::string> names);
  /// The sites of each body, by its index: the model's frames and those of constraints.
  const std::vector<std::vector<Site>>& sites() const { return sites_; }
  /// Writes <equality> with all constraints, and with the dependences of joints.
  void write(const Joints& joints);

 private:
  /// A body, or a frame on it.
  struct Place {
    std::size_t body;
    SE3<double> pose;
    bool is_site;  ///< of MuJoCo: frames are, bodies are not
  };
  struct Tie {
    const ConstraintDescription* constraint;
    std::string one, other;  ///< sites
    bool weld;
    bool unnamed_axis = false;  ///< a second tie of the same constraint
  };
  void findTies(const ConstraintDescription& c, const FrameConstraint& f);
  std::string siteOf(const std::string& frame, const SE3<double>& placement, const std::string& name);
  void begin(const char* element, const std::string& name);
  void couple(const std::string& name, const std::string& joint, const std::string& master, const std::vector<double>& coefficients);
  void putFeedback(const Baumgarte& gains);
  void relate(const ConstraintDescription& c, const Joints& joints);

  const Model& model_;
  xml::Output& out_;
  std::set<std::string> names_, used_;
  std::unordered_map<std::string, Place> places_;
  std::vector<std::vector<Site>> sites_;
  std::vector<Tie> ties_;
  bool open_ = false;  ///< whether <equality> is
};

}  // namespace dyn::mjcf
