-- The cart of cart.urdf as an RBDL model, to be loaded with a free flyer. Lua has no friction, no limits and no volumes for collision. `joint_name` is
-- read by libdyn only.

local y, z = { { 0, 1, 0, 0, 0, 0 } }, { { 0, 0, 1, 0, 0, 0 } }

local function body(mass, com, xx, yy, zz, xz)
  xz = xz or 0
  return { mass = mass, com = com, inertia = { { xx, 0, xz }, { 0, yy, 0 }, { xz, 0, zz } } }
end

local frames = {
  { name = "chassis", parent = "ROOT", joint_name = "root_joint", body = body(12, { 0.02, 0, 0.05 }, 0.144, 0.2644, 0.3796, 0.004) },
}

local function add(name, parent, joint_name, joint, r, link)
  frames[#frames + 1] = { name = name, parent = parent, joint_name = joint_name, joint = joint, joint_frame = { r = r }, body = link }
end

-- A passive wheel on a fork that swivels.
local function caster(name, x)
  add(name .. "fork", "chassis", name .. "swivel", z, { x, 0, -0.02 }, body(0.3, { -0.015, 0, -0.02 }, 0.0002, 0.00025, 0.0001, 0.00002))
  add(name .. "roller", name .. "fork", name .. "roll", y, { -0.03, 0, -0.04 }, body(0.2, { 0, 0, 0 }, 0.00009, 0.00016, 0.00009))
end

local function driven(name, side)
  add(name .. "wheel", "chassis", name .. "drive", y, { 0, side * 0.19, 0 }, body(0.8, { 0, 0, 0 }, 0.0021, 0.004, 0.0021))
end

caster("back_", -0.22)
caster("front_", 0.22)
driven("left_", 1)
driven("right_", -1)

return { name = "cart", gravity = { 0, 0, -9.81 }, frames = frames }
