-- The four-bar linkage of four_bar.urdf as an RBDL model. The only constraint set closes the loop at C: all but the rotation about y is held, because
-- RBDL's loops hold single directions.

local y = { { 0, 1, 0, 0, 0, 0 } }

local function body(mass, com, xx, yy, zz)
  return { mass = mass, com = com, inertia = { { xx, 0, 0 }, { 0, yy, 0 }, { 0, 0, zz } } }
end

return {
  name = "four_bar",
  gravity = { 0, 0, -9.81 },
  frames = {
    { name = "base", parent = "ROOT", joint_name = "root_joint" },
    { name = "crank", parent = "base", joint_name = "A", joint = y, body = body(0.2, { 0, 0, 0.05 }, 2e-4, 2e-4, 1e-5) },
    { name = "coupler", parent = "crank", joint_name = "B", joint = y, joint_frame = { r = { 0, 0, 0.1 } },
      body = body(0.5, { 0.175, 0, 0 }, 2e-5, 5.1e-3, 5.1e-3) },
    { name = "rocker", parent = "base", joint_name = "D", joint = y, joint_frame = { r = { 0.3, 0, 0 } },
      body = body(0.4, { 0, 0, 0.15 }, 3e-3, 3e-3, 2e-5) },
  },
  local_frames = {
    { name = "coupler_end", body = "coupler", r = { 0.35, 0, 0 } },
    { name = "rocker_end", body = "rocker", r = { 0, 0, 0.3 } },
  },
  constraint_sets = {
    loop = {
      { constraint_type = "loop", name = "C", predecessor_local_frame = "rocker_end", successor_local_frame = "coupler_end",
        axis_sets = {
          { 0, 0, 0, 1, 0, 0 }, { 0, 0, 0, 0, 1, 0 }, { 0, 0, 0, 0, 0, 1 }, { 1, 0, 0, 0, 0, 0 }, { 0, 0, 1, 0, 0, 0 },
        } },
    },
  },
}
