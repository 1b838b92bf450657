// SPDX-License-Identifier: BSD-2-Clause
// dyn compute reads states and writes results by key.
#include "command.hpp"
#include "errors.hpp"
#include "support/shared.hpp"

using namespace dyn::test;
using namespace dyn::tool;

TEST_CASE("what has no mass has all results but those of its centre of mass", "[command]") {
  const Folder folder;
  const std::string robot = folder.write("light.urdf", R"(<robot name="light"><link name="a"/><link name="b"/>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint></robot>)");
  const std::string states = folder.write("states.json", R"({"samples":[{"q":[1,0]}]})");
  const Answer a = run("compute '" + robot + "' --states '" + states + "'");
  INFO(a.err);
  REQUIRE(a.code == 0);
  const nlohmann::json sample = nlohmann::json::parse(a.out)["samples"][0];
  CHECK(sample["rnea"] == nlohmann::json{0.0});
  for (const std::string key : {"com", "vcom", "acom", "Jcom", "hg", "aba"}) {
    INFO(key);
    CHECK(sample[key].is_null());
    CHECK_THAT(sample[key + "_error"].get<std::string>(), containing("mass"));
  }
  CHECK(run("compute '" + robot + "' --states '" + states + "' --only com").code == 1);
}

TEST_CASE("states that cannot be used are refused with the sample's number", "[command]") {
  const Folder folder;
  const auto compute = [&](const std::string& states) {
    return run("compute " + biped + " --root free_flyer --states " + folder.write("states.json", states));
  };
  const auto refused = [&](const std::string& states, const std::string& why) {
    const Answer a = compute(states);
    INFO(states << "\n" << a.err);
    CHECK(a.code == 1);
    CHECK(a.out.empty());
    CHECK_THAT(a.err, containing(why) && containing("states.json"));
  };
  CHECK(compute(zero_state).code == 0);
  refused("", "not JSON");
  refused("[1,2", "not JSON");
  refused("{}", "samples");
  refused(R"({"samples":[1]})", "sample 0");
  refused(R"({"samples":[{"v":[]}]})", "sample 0: q is missing");
  refused(R"({"samples":[{"q":[1,2]}]})", "sample 0: q has 2 entries");
  refused(R"({"samples":[{"q":"x"}]})", "sample 0: q is not an array");
  std::string second = zero_state;
  second.insert(second.rfind("]}"), "," + zero_state.substr(zero_state.find("{\"q\""), zero_state.rfind("]}") - zero_state.find("{\"q\"")));
  CHECK(compute(second).code == 0);
  for (const char* number : {"NaN", "Infinity", "-Infinity", "1e999"}) {
    std::string bad = second;
    bad.replace(bad.rfind("0.1"), 3, number);
    INFO(number);
    const Answer a = compute(bad);
    CHECK(a.code == 1);
    CHECK_THAT(a.err, containing("sample 1") && containing("not finite"));
  }
  CHECK(run("compute " + biped + " --states /nowhere.json").code == 1);
  const std::string fine = folder.write("fine.json", zero_state);
  CHECK_THAT(run("compute " + biped + " --root free_flyer --states " + fine + " --only speed").err, containing("speed"));
  CHECK_THAT(run("compute " + biped + " --root free_flyer --states " + fine + " --frames nose").err, containing("nose"));
}

TEST_CASE("compute knows contacts by frames", "[command]") {
  const Folder folder;
  const std::string states = folder.write("states.json", zero_state), line = "compute " + biped + " --root free_flyer --states " + states;
  const Answer all = run(line + " --contacts left_foot:6d,right_foot:3d");
  INFO(all.err);
  CHECK(all.code == 0);
  const nlohmann::json sample = nlohmann::json::parse(all.out)["samples"][0];
  for (const char* key : {"contact_lambda", "contact_gamma", "impulse_lambda", "impulse_restitution_0.5_lambda"}) CHECK(sample[key].size() == 9);
  for (const char* key : {"contact_ddq", "impulse_v_after", "impulse_restitution_0.5_v_after"}) CHECK(sample[key].size() == sample["v"].size());
  CHECK(sample["contact_J"].size() == 9 * sample["v"].size());
  CHECK(sample.contains("rnea"));
  const nlohmann::json one = nlohmann::json::parse(run(line + " --contacts left_foot:6d --only contact_ddq").out)["samples"][0];
  CHECK(one.contains("contact_ddq"));
  CHECK_FALSE(one.contains("contact_lambda"));
  CHECK_FALSE(one.contains("rnea"));
  const Answer half = run(line + " --contacts left_foot");
  CHECK(half.code == 2);
  CHECK_THAT(half.err, containing("FRAME:6d or FRAME:3d"));
  CHECK_THAT(run(line + " --contacts nose:6d").err, containing("no body or frame 'nose'"));
  CHECK_THAT(run(line + " --contacts left_foot:6d,left_foot:3d").err, containing("two constraints of that name"));
  const Answer none = run(line + " --only contact_ddq");
  CHECK(none.code == 2);
  CHECK_THAT(none.err, containing("name the contacts"));
}

TEST_CASE("compute takes a golden file as it is and answers with its keys", "[command]") {
  DYN_NEEDS_SHARED();
  const std::string file = sharedFolder() + "/golden/hyq.json";
  const nlohmann::json golden = readJson(file);
  std::string frames;
  for (const auto& frame : golden["jacobian_frames"]) frames += (frames.empty() ? "" : ",") + frame["name"].get<std::string>();
  const Answer a = run("compute " + sharedFolder() + "/models/" + golden["file"].get<std::string>() + " --root " + golden["root"].get<std::string>() +
                       " --states " + file + " --frames " + frames);
  REQUIRE(a.code == 0);
  const nlohmann::json answer = nlohmann::json::parse(a.out);
  for (const char* key : {"robot", "root", "nq", "nv", "gravity"}) CHECK(answer[key] == golden[key]);
  REQUIRE(answer["joints"].size() == golden["joints"].size());
  for (std::size_t j = 0; j < golden["joints"].size(); ++j)
    for (const char* key : {"name", "parent", "idx_q", "idx_v", "nq", "nv"}) CHECK(answer["joints"][j][key] == golden["joints"][j][key]);
  REQUIRE(answer["samples"].size() == golden["samples"].size());
  const nlohmann::json &x = answer["samples"][3], &y = golden["samples"][3];
  for (const char* key : {"rnea",
                          "nle",
                          "gravity_torque",
                          "M",
                          "aba",
                          "com",
                          "vcom",
                          "acom",
                          "Jcom",
                          "frame0_J_local",
                          "frame1_dJ_local",
                          "frame0_J_world",
                          "frame1_velocity_local",
                          "frame0_acceleration_world_aligned_classical",
                          "Minv",
                          "dtau_dq",
                          "dtau_dv",
                          "ddq_dq",
                          "ddq_dv",
                          "hg",
                          "Ag",
                          "dAg",
                          "dhg",
                          "coriolis_matrix",
                          "dhg_dq",
                          "dhgdot_dq",
                          "dhgdot_dv",
                          "dhgdot_da"}) {
    INFO(key);
    CHECK(relativeError(x[key].get<std::vector<double>>(), flatten(y[key])) < 200);
  }
  for (std::size_t f = 0; f < y["oMf"].size(); ++f) CHECK(x["oMf"][f]["name"] == y["oMf"][f]["name"]);

  const Answer only =
      run("compute " + sharedFolder() + "/models/" + golden["file"].get<std::string>() + " --root free_flyer --only M,rnea --states " + file);
  const nlohmann::json sample = nlohmann::json::parse(only.out)["samples"][0];
  CHECK(sample.contains("M"));
  CHECK(!sample.contains("aba"));
}

TEST_CASE("where the mass matrix is singular aba says so", "[command]") {
  DYN_NEEDS_SHARED();
  const Folder folder;
  const std::string robot = sharedFolder() + "/models/romeo.urdf";
  const Answer info = run("info " + robot);
  REQUIRE(info.code == 0);
  const Answer bench = run("bench " + robot + " --only rnea,aba --states 4 --json");
  CHECK_THAT(bench.err, containing("aba") && containing("singular"));
  CHECK_THAT(bench.out, !containing("\"aba\""));
}
