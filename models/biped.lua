-- The biped of biped.urdf as an RBDL model, to be loaded with a free flyer. The right side mirrors the left one. `joint_name` is read by libdyn only.

local axes = { x = { 1, 0, 0, 0, 0, 0 }, y = { 0, 1, 0, 0, 0, 0 }, z = { 0, 0, 1, 0, 0, 0 } }

local function body(mass, com, xx, yy, zz, xy, xz, yz)
  xy, xz, yz = xy or 0, xz or 0, yz or 0
  return { mass = mass, com = com, inertia = { { xx, xy, xz }, { xy, yy, yz }, { xz, yz, zz } } }
end

local frames = {
  { name = "torso", parent = "ROOT", joint_name = "root_joint", body = body(14.2, { 0, 0, 0.18 }, 0.31, 0.27, 0.14, 0.001, -0.004, 0.002) },
  { name = "head", parent = "torso", joint_name = "neck", joint_frame = { r = { 0, 0, 0.42 } }, body = body(1.9, { 0.02, 0, 0.06 }, 0.011, 0.012, 0.008) },
}

local function side(name, s)
  local function add(link, parent, joint, axis, origin, inertia)
    frames[#frames + 1] = {
      name = name .. link, parent = parent, joint_name = name .. joint, joint = { axis }, joint_frame = { r = origin }, body = inertia,
    }
  end
  add("hip_yaw_link", "torso", "hip_yaw", axes.z, { 0, s * 0.09, -0.03 }, body(0.8, { 0, 0, -0.02 }, 0.001, 0.0011, 0.0009))
  add("hip_roll_link", name .. "hip_yaw_link", "hip_roll", axes.x, { 0, 0, -0.06 }, body(1.1, { 0, 0, 0 }, 0.0016, 0.0018, 0.0015))
  add("thigh", name .. "hip_roll_link", "hip_pitch", axes.y, { 0, 0, 0 }, body(4.3, { 0, s * 0.01, -0.17 }, 0.052, 0.053, 0.009))
  add("shin", name .. "thigh", "knee", axes.y, { 0, 0, -0.38 }, body(2.6, { 0.01, 0, -0.15 }, 0.031, 0.031, 0.004))
  add("ankle", name .. "shin", "ankle_pitch", axes.y, { 0, 0, -0.37 }, body(0.3, { 0, 0, 0 }, 0.0002, 0.0002, 0.0002))
  add("foot", name .. "ankle", "ankle_roll", axes.x, { 0, 0, 0 }, body(1.2, { 0.03, 0, -0.04 }, 0.0012, 0.004, 0.0045))
  add("upper_arm", "torso", "shoulder", { 0, 0.96, s * 0.28, 0, 0, 0 }, { 0, s * 0.2, 0.36 }, body(1.7, { 0, s * 0.02, -0.12 }, 0.012, 0.012, 0.002))
  add("forearm", name .. "upper_arm", "elbow", axes.y, { 0, 0, -0.26 }, body(1.2, { 0.02, 0, -0.11 }, 0.009, 0.009, 0.001))
end

side("left_", 1)
side("right_", -1)

return { name = "biped", gravity = { 0, 0, -9.81 }, frames = frames }
