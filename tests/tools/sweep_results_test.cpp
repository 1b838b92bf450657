// SPDX-License-Identifier: BSD-2-Clause
// dyn sweep: the results of each task, against the commands that compute one state or motion, and what varies.
#include "sweep_study.hpp"

using namespace dyn::test;

TEST_CASE("a sample of a sweep is what dyn simulate computes from its inputs", "[command][sweep]") {
  NEEDS_RESULTS();
  Sweep s;
  s.study["integrator"] = "dormand_prince";
  s.study["keep"] = {"final", "trajectory", "energy"};
  s.study["every"] = 0.01;
  s.digest("out");
  const Json sample = s.replay("out", 17);
  const std::string state = s.write("state.json", Json{{"samples", {sample["input"]}}}.dump()), path = s.out("path.json");
  const Answer answer = run("simulate " DYN_SOURCE_DIR "/models/arm.urdf --integrator dormand_prince --time 0.05 --every 0.01 --state '" + state +
                            "' --out '" + path + "'");
  REQUIRE(answer.code == 0);
  const Json states = Json::parse(textOf(path))["states"];
  CHECK(states.back()["q"] == sample["results"]["q_final"]);
  CHECK(states.back()["v"] == sample["results"]["v_final"]);
  Json all = Json::array();
  for (const Json& one : states)
    for (const Json& x : one["q"]) all.push_back(x);
  CHECK(all == sample["results"]["q"]);
  CHECK(states.back()["energy"] == sample["results"]["energy_final"]);
}

TEST_CASE("a sweep of functions has the numbers of dyn compute", "[command][sweep]") {
  NEEDS_RESULTS();
  Sweep s;
  s.study = {{"model", DYN_SOURCE_DIR "/models/biped.urdf"},
             {"root", "free_flyer"},
             {"task", "compute"},
             {"samples", 5},
             {"functions", {"rnea", "M", "com", "Ag", "kinetic_energy"}},
             {"frames", {"left_foot"}},
             {"vary", {{"q", {{"normal", {0, 0.3}}}}, {"v", {{"uniform", {-1, 1}}}}, {"a", 0.5}}}};
  s.digest("out");
  const Json sample = s.replay("out", 3);
  const std::string state = s.write("state.json", Json{{"samples", {sample["input"]}}}.dump());
  const Json expected = Json::parse(run("compute '" + biped + "' --root free_flyer --states '" + state + "'").out)["samples"][0];
  for (const char* key : {"com", "kinetic_energy"}) CHECK(sample["results"][key] == expected[key]);
  // A sweep computes states side by side, which rounds differently.
  for (const char* key : {"rnea", "M", "Ag"}) {
    CAPTURE(key);
    CHECK(off(sample["results"][key], expected[key]) < 1e-14);
  }
  for (const Json& frame : expected["oMf"])
    if (frame["name"] == "left_foot") CHECK(off(sample["results"]["frames/left_foot/p"], frame["p"]) < 1e-15);
}

TEST_CASE("functions of samples that are computed side by side do not depend on their neighbours", "[command][sweep]") {
  NEEDS_RESULTS();
  Sweep s;
  const Json states = {{"q", {{"uniform", "limits"}}}, {"v", {{"uniform", {-1, 1}}}}, {"a", {{"normal", {0, 1}}}}};
  Json masses = states, others = states;
  int count = 0;
  masses["bodies"] = {{"hand", {{"mass", {{"uniform", {0.5, 2}}}}, {"com", {{"normal", {0, 0.1}}}}}}};
  others["joints"] = {{"wrist3", {{"armature", {{"uniform", {0, 1}}}}}}};
  others["gravity"] = {{"normal", {0, 5}}};
  for (const Json& vary : {states, masses, others}) {
    CAPTURE(vary.dump());
    s.study = {{"model", DYN_SOURCE_DIR "/models/arm.urdf"},
               {"task", "compute"},
               {"samples", 150},
               {"functions", {"rnea", "M", "aba", "Minv", "com", "potential_energy"}},
               {"frames", {"hand"}},
               {"vary", vary}};
    std::string first;
    for (const int chunk : {1, 67, 150}) {
      CAPTURE(chunk);
      s.study["chunk"] = chunk;
      const std::string name = std::to_string(++count);
      const std::string digest = s.digest(name);
      if (first.empty()) first = digest;
      CHECK(digest == first);
    }
  }
  // Results have the masses of their own sample, also beside others.
  s.study["vary"] = {{"q", 0.4}, {"bodies", {{"hand", {{"mass", {{"list", {1, 3}}}}}}}}};
  s.study["samples"] = 2;
  s.study.erase("chunk");
  s.digest("two");
  s.study["vary"]["bodies"]["hand"]["mass"] = 3;
  s.digest("heavy");
  CHECK(s.replay("two", 1)["results"]["M"] == s.replay("heavy", 0)["results"]["M"]);
  CHECK(s.replay("two", 1)["results"]["M"] != s.replay("two", 0)["results"]["M"]);
}

TEST_CASE("one sample that fails beside others fails alone", "[command][sweep]") {
  NEEDS_RESULTS();
  Sweep s;
  s.study = {{"model", DYN_SOURCE_DIR "/models/arm.urdf"},
             {"task", "compute"},
             {"samples", 40},
             {"functions", {"rnea", "aba"}},
             {"vary", {{"bodies", {{"hand", {{"mass", {{"grid", {-3, 36, 40}}}}}}}}, {"q", {{"uniform", "limits"}}}}}};
  s.study["chunk"] = 40;
  const std::string together = s.digest("together");
  s.study["chunk"] = 1;
  CHECK(s.digest("apart") == together);
  const std::string failures = textOf(s.path / "together/failures.jsonl");
  CHECK(failures == textOf(s.path / "apart/failures.jsonl"));
  CHECK(std::count(failures.begin(), failures.end(), '\n') == 4);
  CHECK_THAT(failures, containing("must be a positive factor"));
}

TEST_CASE("a controller moves joints to their target, with torques within the limits of effort", "[command][sweep]") {
  NEEDS_RESULTS();
  Sweep s;
  s.study = {
      {"model", DYN_SOURCE_DIR "/models/arm.urdf"},
      {"task", "simulate"},
      {"time", 0.3},
      {"vary",
       {{"gravity", 0},
        {"q", 0},
        {"pd",
         {{"kp", {{"joints", {{"wrist3", 5}}}}}, {"kd", {{"joints", {{"wrist3", {{"list", {0.1, 0.15}}}}}}}}, {"target", {{"list", {0.3, 0.5}}}}}}}},
      {"keep", {"final"}}};
  s.digest("out", "--threads 1");
  CHECK(s.digest("again", "--threads 3") == s.digestOf("out"));
  for (int k = 0; k < 4; ++k) {
    CAPTURE(k);
    const Json sample = s.replay("out", k);
    REQUIRE(sample["failed"] == false);
    CHECK(sample["input"]["pd.target"].back() == (k % 2 == 0 ? 0.3 : 0.5));
    CHECK(sample["input"]["pd.kd"].back() == (k < 2 ? 0.1 : 0.15));
    CHECK(std::abs(sample["results"]["q_final"].back().get<double>() - sample["input"]["pd.target"].back().get<double>()) < 1e-3);
  }
  // A step of Euler's method from rest changes v by dt M^-1 tau, so that v tells the torque.
  s.study = {{"model", DYN_SOURCE_DIR "/models/arm.urdf"},
             {"task", "simulate"},
             {"time", 0.001},
             {"integrator", "semi_implicit_euler"},
             {"effort_limits", true},
             {"vary",
              {{"gravity", 0},
               {"pd", {{"kp", 1e6}, {"target", {{"joints", {{"wrist3", 1}}}}}}},
               {"joints", {{"wrist3", {{"effort", {{"list", {1, 2, 0}}}}}}}}}},
             {"keep", {"final"}}};
  s.digest("clipped");
  const auto speed = [&](int k) { return s.replay("clipped", k)["results"]["v_final"].back().get<double>(); };
  CHECK(speed(0) > 0);
  CHECK(std::abs(speed(1) / speed(0) - 2) < 1e-9);
  CHECK(speed(2) == 0);
  const std::pair<Json, const char*> faults[] = {{{{"pd", {{"kp", 1}}}, {"joints", {{"wrist3", {{"velocity", 1}}}}}}, "acts only in the task python"},
                                                 {{{"pd", {{"kp", 1}}}, {"joints", {{"wrist3", {{"upper", 1}}}}}}, "acts only with \"limits\": true"},
                                                 {{{"pd", {{"target", 1}}}}, "has neither 'kp' nor 'kd'"},
                                                 {{{"pd", {{"ki", 1}}}}, "has an unknown member 'ki'"},
                                                 {{{"pd", {{"kp", {{"uniform", "limits"}}}}}}, "no limits of gains"},
                                                 {{{"q", 0}}, "there are no torques to limit"}};
  for (const auto& [vary, message] : faults) {
    s.study["vary"] = vary;
    CHECK_THAT(s.sweep("none").err, containing(message));
  }
}

TEST_CASE("limits of positions vary, and joints stop at those of their sample", "[command][sweep]") {
  NEEDS_RESULTS();
  Sweep s;
  s.study = {{"model", DYN_SOURCE_DIR "/models/arm.urdf"},
             {"task", "simulate"},
             {"time", 0.4},
             {"dt", 0.01},
             {"limits", true},
             {"samples", 8},
             {"vary", {{"gravity", 0}, {"v", {{"joints", {{"wrist3", 5}}}}}, {"joints", {{"wrist3", {{"upper", {{"uniform", {0.1, 1}}}}}}}}}},
             {"keep", {"extremes", "inputs"}}};
  s.digest("out", "--threads 1");
  CHECK(s.digest("again", "--threads 3") == s.digestOf("out"));
  double least = 2, most = 0;
  for (int k = 0; k < 8; ++k) {
    const Json sample = s.replay("out", k);
    REQUIRE(sample["failed"] == false);
    const double upper = sample["input"]["joints.wrist3.upper"][0], reached = sample["results"]["q_max"].back();
    CHECK(std::abs(reached - upper) < 1e-6);
    least = std::min(least, upper), most = std::max(most, upper);
  }
  CHECK(least < most);
  s.study["vary"]["joints"]["wrist3"] = {{"upper", {{"list", {-1, 1}}}}, {"lower", 0}};
  CHECK(s.sweep("inverted").code == 0);
  CHECK(Json::parse(run("sweep --status '" + s.out("inverted") + "'").out)["failed"] == 4);
}

TEST_CASE("volumes touch in samples whose friction varies as they do in dyn simulate", "[command][sweep]") {
  NEEDS_RESULTS();
  Sweep s;
  const std::string model =
      s.write("box.urdf",
              "<robot name='box'><link name='ground'><collision><origin xyz='0 0 -0.5'/><geometry><box size='9 9 1'/>"
              "</geometry></collision></link><link name='x'><inertial><mass value='0.1'/><inertia ixx='1' iyy='1' izz='1' "
              "ixy='0' ixz='0' iyz='0'/></inertial></link><link name='box'><inertial><mass value='1'/><inertia ixx='1' iyy='1' "
              "izz='1' ixy='0' ixz='0' iyz='0'/></inertial><collision><geometry><box size='0.2 0.2 0.2'/></geometry></collision>"
              "</link><joint name='slide' type='prismatic'><parent link='ground'/><child link='x'/><axis xyz='1 0 0'/><limit "
              "effort='1' velocity='9' lower='-9' upper='9'/></joint><joint name='lift' type='prismatic'><parent link='x'/>"
              "<child link='box'/><axis xyz='0 0 1'/><limit effort='1' velocity='9' lower='-9' upper='9'/></joint></robot>");
  s.study = {{"model", "box.urdf"},
             {"task", "simulate"},
             {"time", 0.1},
             {"touching", true},
             {"vary", {{"friction", {{"list", {0.1, 0.5}}}}, {"q", {{"list", {{0, 0.1}}}}}, {"v", {{"list", {{1, 0}}}}}}},
             {"keep", {"final"}}};
  s.digest("out", "--threads 1");
  for (int k = 0; k < 2; ++k) {
    const Json sample = s.replay("out", k);
    const std::string state = s.write("state.json", Json{{"samples", {sample["input"]}}}.dump()), path = s.out("path.json");
    const Answer answer = run("simulate '" + model + "' --touching --time 0.1 --friction " + (k == 0 ? "0.1" : "0.5") + " --state '" + state +
                              "' --out '" + path + "'");
    INFO(answer.err);
    REQUIRE(answer.code == 0);
    CHECK(Json::parse(textOf(path))["states"].back()["v"] == sample["results"]["v_final"]);
  }
  CHECK(s.replay("out", 1)["results"]["v_final"][0].get<double>() < s.replay("out", 0)["results"]["v_final"][0].get<double>() - 0.1);
}

TEST_CASE("a sweep of collisions has the distances of dyn collide", "[command][sweep]") {
  NEEDS_RESULTS();
  Sweep s;
  const auto link = [](const std::string& name, const std::string& volume) {
    return "<link name='" + name + "'>" + (volume.empty() ? "" : "<collision><geometry>" + volume + "</geometry></collision>") + "</link>";
  };
  const auto slide = [](const std::string& name, const std::string& parent, const std::string& child, const std::string& axis) {
    return "<joint name='" + name + "' type='prismatic'><parent link='" + parent + "'/><child link='" + child + "'/><axis xyz='" + axis +
           "'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>";
  };
  const std::string model = s.write("slides.urdf", "<robot name='slides'>" + link("base", "<sphere radius='0.3'/>") + link("middle", "") +
                                                       link("end", "<sphere radius='0.2'/>") + slide("x", "base", "middle", "1 0 0") +
                                                       slide("y", "middle", "end", "0 1 0") + "</robot>");
  s.study = {{"model", "slides.urdf"}, {"task", "collide"}, {"samples", 20}, {"vary", {{"q", {{"uniform", "limits"}}}}}};
  s.digest("out");
  int collisions = 0;
  for (const int k : {0, 1, 2, 3, 4, 5, 6, 7}) {
    const Json sample = s.replay("out", k), &results = sample["results"];
    const double x = sample["input"]["q"][0], y = sample["input"]["q"][1], distance = results["distance"];
    CHECK(std::abs(distance - (std::hypot(x, y) - 0.5)) < 1e-12);
    CHECK(results["collides"] == static_cast<int>(distance < 0));
    CHECK(results["collisions"] == static_cast<int>(distance < 0));
    collisions += distance < 0;
  }
  CHECK((collisions > 0 && collisions < 8));
  const Json sample = s.replay("out", 2);
  const std::string state = s.write("state.json", Json{{"samples", {sample["input"]}}}.dump());
  const Json expected = Json::parse(run("collide '" + model + "' --states '" + state + "'").out)["states"][0];
  CHECK(sample["results"]["distance"] == expected["minimum"]["distance"]);
}

TEST_CASE("bodies, joints, gravity and lists vary as the study says", "[command][sweep]") {
  NEEDS_RESULTS();
  Sweep s;
  s.study = {{"model", DYN_SOURCE_DIR "/models/four_bar.urdf"},
             {"task", "compute"},
             {"functions", {"gravity_torque"}},
             {"vary", {{"gravity", {{"list", {{0, 0, -9.81}, {0, 0, -1.62}}}}}, {"q", {{"grid", {0.1, 0.5, Json::array({3, 1, 1})}}}}}}};
  s.digest("out");
  const Json manifest = Json::parse(textOf(s.path / "out/manifest.json"));
  CHECK(manifest["samples"] == 6);
  const Json first = s.replay("out", 0), last = s.replay("out", 5);
  CHECK(first["input"]["gravity"] == Json{0, 0, -9.81});
  CHECK(last["input"]["gravity"] == Json{0, 0, -1.62});
  // The crank's joint is continuous: its coordinates are cosine and sine.
  const auto angle = [](const Json& sample) { return std::atan2(sample["input"]["q"][1].get<double>(), sample["input"]["q"][0].get<double>()); };
  CHECK(std::abs(angle(first) - 0.1) < 1e-15);
  CHECK(std::abs(angle(last) - 0.5) < 1e-15);
  CHECK(last["input"]["q"][2] == 0.1);
  s.study = {{"model", DYN_SOURCE_DIR "/models/arm.urdf"},
             {"task", "compute"},
             {"functions", {"M"}},
             {"samples", 2},
             {"vary", {{"bodies", {{"hand", {{"mass", {{"list", {1, 3}}}}}}}}, {"joints", {{"wrist3", {{"armature", 0.25}}}}}}}};
  s.digest("masses");
  const Json light = s.replay("masses", 0)["results"]["M"], heavy = s.replay("masses", 1)["results"]["M"];
  CHECK(heavy[0].get<double>() > light[0].get<double>());
  CHECK(light.back().get<double>() > 0.25);
}
