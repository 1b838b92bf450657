-- The arm of arm.urdf as an RBDL model. Lua has no limits and no volumes for collision. `joint_name` is read by libdyn only.

local z, y = { { 0, 0, 1, 0, 0, 0 } }, { { 0, 1, 0, 0, 0, 0 } }
local y_backwards = { { 0, -1, 0, 0, 0, 0 } }

local function body(mass, com, xx, yy, zz, yz)
  yz = yz or 0
  return { mass = mass, com = com, inertia = { { xx, 0, 0 }, { 0, yy, yz }, { 0, yz, zz } } }
end

local frames = { { name = "base", parent = "ROOT", joint_name = "root_joint", body = body(6, { 0, 0, 0.07 }, 0.03, 0.03, 0.04) } }

-- Each link stands on the one before, `height` above its origin.
local function add(name, joint_name, axis, height, link)
  frames[#frames + 1] = {
    name = name, parent = frames[#frames].name, joint_name = joint_name, joint = axis, joint_frame = { r = { 0, 0, height } }, body = link,
  }
end

add("shoulder", "shoulder1", z, 0.16, body(3.5, { 0, 0.01, 0.08 }, 0.014, 0.012, 0.009, 0.001))
add("upper_arm", "shoulder2", y, 0.19, body(3.4, { 0, 0, 0.1 }, 0.016, 0.016, 0.007))
add("elbow", "roll", z, 0.22, body(2.8, { 0, 0, 0.09 }, 0.011, 0.011, 0.005))
add("forearm", "bend", y_backwards, 0.2, body(2.3, { 0, 0, 0.09 }, 0.009, 0.009, 0.004))
add("wrist", "wrist1", z, 0.2, body(1.6, { 0, 0, 0.07 }, 0.005, 0.005, 0.002))
add("hand", "wrist2", y, 0.17, body(1.2, { 0, 0, 0.02 }, 0.002, 0.002, 0.0015))
add("flange", "wrist3", z, 0.08, body(0.5, { 0, 0, 0.03 }, 0.0006, 0.0006, 0.0005))

return { name = "arm", gravity = { 0, 0, -9.81 }, frames = frames }
