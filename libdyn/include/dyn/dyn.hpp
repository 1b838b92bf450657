// SPDX-License-Identifier: BSD-2-Clause
// Includes all of the library's dynamics and simulation. Parsers, geometry and code generation have headers of their own.
#pragma once

#include <dyn/algorithm/aba.hpp>
#include <dyn/algorithm/batch.hpp>
#include <dyn/algorithm/batch_derivatives.hpp>
#include <dyn/algorithm/center_of_mass.hpp>
#include <dyn/algorithm/centroidal.hpp>
#include <dyn/algorithm/cholesky.hpp>
#include <dyn/algorithm/compute.hpp>
#include <dyn/algorithm/configuration.hpp>
#include <dyn/algorithm/coriolis.hpp>
#include <dyn/algorithm/crba.hpp>
#include <dyn/algorithm/derivatives.hpp>
#include <dyn/algorithm/jacobians.hpp>
#include <dyn/algorithm/kinematics.hpp>
#include <dyn/algorithm/kinematics_derivatives.hpp>
#include <dyn/algorithm/layout.hpp>
#include <dyn/algorithm/named_configuration.hpp>
#include <dyn/algorithm/regressor.hpp>
#include <dyn/algorithm/rnea.hpp>
#include <dyn/algorithm/second_derivatives.hpp>
#include <dyn/algorithm/states.hpp>
#include <dyn/compile/compile.hpp>
#include <dyn/constraint/assembly.hpp>
#include <dyn/constraint/batch.hpp>
#include <dyn/constraint/delassus.hpp>
#include <dyn/constraint/derivatives.hpp>
#include <dyn/constraint/dynamics.hpp>
#include <dyn/constraint/friction.hpp>
#include <dyn/data/data_pool.hpp>
#include <dyn/integrate/batch_stepper.hpp>
#include <dyn/integrate/islands.hpp>
#include <dyn/integrate/simulator.hpp>
#include <dyn/spatial/eigen.hpp>
#include <dyn/spatial/inertial_parameters.hpp>
