local body = { mass = 1, com = { 0, 0, 0.1 }, inertia = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } }
local child = setmetatable({ name = "c" }, { __index = { parent = "b", joint = { "JointTypeEulerZYX" }, body = body } })
return {
  gravity = { 0, 0, -9.81 },
  frames = {
    { name = "a", parent = "ROOT", joint = { "JointTypeFloatingBase" }, body = body, markers = { M = { 0, 0, 1 } } },
    { name = "b", parent = "a", joint = { { 0, 0, 1, 0, 0, 0.2 }, { 0, 0, 0, 1, 0, 0 } }, joint_frame = { r = { 0, 0, 1 }, E = { { 0, 1, 0 }, { -1, 0, 0 }, { 0, 0, 1 } } },
      body = body, visuals = { { geometry = { sphere = { radius = 0.1 } }, rotate = { axis = { 0, 0, 1 }, angle = 30 } }, { src = "a.obj", scale = 2 } } },
    child,
  },
  points = { { name = "P", body = "c", point = { 1, 0, 0 } } },
  constraint_sets = {
    s = { { constraint_type = "contact", point_name = "P", normal_sets = { { 1, 0, 0 }, { 0, 0, 1 } } } },
    t = { { constraint_type = "loop", predecessor_body = "a", successor_body = "c", axis = { 0, 0, 0, 0, 1, 0 }, enable_stabilization = true } },
  },
}
