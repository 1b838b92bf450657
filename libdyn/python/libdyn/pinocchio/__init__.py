# SPDX-License-Identifier: BSD-2-Clause
"""libdyn under the names of Pinocchio's Python module: import libdyn.pinocchio as pin.

Names, argument orders and results are those of Pinocchio 3.7. A Model may be changed at any time; it is compiled when an algorithm first needs it.
Data computes most of its fields when they are read. libdyn/doc/pinocchio.md says what differs and what is missing.
"""

import numpy as _numpy

from .. import ArgumentPosition, ReferenceFrame  # noqa: F401
from .. import __version__ as _version
from . import cholesky, liegroups, linalg, missing, rpy, utils, visualize  # noqa: F401
from ._random import seed  # noqa: F401
from .centroidal import (  # noqa: F401
    ccrba,
    computeCentroidalDynamicsDerivatives,
    computeCentroidalMap,
    computeCentroidalMapTimeVariation,
    computeCentroidalMomentum,
    computeCentroidalMomentumTimeVariation,
    dccrba,
    getCentroidalDynamicsDerivatives,
)
from .collision import (  # noqa: F401
    ComputeCollision,
    ComputeDistance,
    computeBodyRadius,
    computeCollision,
    computeCollisions,
    computeDistance,
    computeDistances,
    updateGeometryPlacements,
)
from .com import (  # noqa: F401
    centerOfMass,
    computeSubtreeMasses,
    computeTotalMass,
    getJacobianSubtreeCenterOfMass,
    jacobianCenterOfMass,
    jacobianSubtreeCenterOfMass,
)
from .configuration import (  # noqa: F401
    dDifference,
    dIntegrate,
    dIntegrateTransport,
    difference,
    distance,
    integrate,
    interpolate,
    isNormalized,
    isSameConfiguration,
    neutral,
    normalize,
    randomConfiguration,
    squaredDistance,
)
from .constraints import (  # noqa: F401
    BaumgarteCorrectorParameters,
    ProximalSettings,
    RigidConstraintData,
    RigidConstraintModel,
    StdVec_RigidConstraintData,
    StdVec_RigidConstraintModel,
    computeConstraintDynamicsDerivatives,
    computeImpulseDynamicsDerivatives,
    constraintDynamics,
    getConstraintJacobian,
    getConstraintsJacobian,
    impulseDynamics,
    initConstraintDynamics,
)
from .contact import computeKKTContactDynamicMatrixInverse, forwardDynamics, getKKTContactDynamicMatrixInverse  # noqa: F401
from .contact_cholesky import ContactCholeskyDecomposition  # noqa: F401
from .containers import (  # noqa: F401
    StdMap_String_VectorXd,
    StdVec_Bool,
    StdVec_Force,
    StdVec_Index,
    StdVec_IndexVector,
    StdVec_Inertia,
    StdVec_Int,
    StdVec_MatrixXs,
    StdVec_Motion,
    StdVec_SE3,
    StdVec_Scalar,
    StdVec_StdString,
    StdVec_Symmetric3,
    StdVec_Vector3,
    StdVec_VectorXb,
    StdVec_VectorXs,
)
from .data import Data  # noqa: F401
from .derivatives import (  # noqa: F401
    computeABADerivatives,
    computeForwardKinematicsDerivatives,
    computeGeneralizedGravityDerivatives,
    computeRNEADerivatives,
    computeStaticTorqueDerivatives,
    getCenterOfMassVelocityDerivatives,
    getFrameAccelerationDerivatives,
    getFrameVelocityDerivatives,
    getJointAccelerationDerivatives,
    getJointVelocityDerivatives,
    getPointClassicAccelerationDerivatives,
    getPointVelocityDerivatives,
)
from .dynamics import (  # noqa: F401
    aba,
    computeAllTerms,
    computeCoriolisMatrix,
    computeGeneralizedGravity,
    computeKineticEnergy,
    computeMechanicalEnergy,
    computeMinverse,
    computePotentialEnergy,
    computeStaticTorque,
    crba,
    getCoriolisMatrix,
    nle,
    nonLinearEffects,
    rnea,
)
from .edit import appendModel, buildReducedModel, findCommonAncestor, transformJointIntoMimic  # noqa: F401
from .enums import (  # noqa: F401
    ACCELERATION,
    ARG0,
    ARG1,
    BODY,
    CONTACT_3D,
    CONTACT_6D,
    ContactType,
    Convention,
    FIXED_JOINT,
    FrameType,
    JOINT,
    KinematicLevel,
    LOCAL,
    LOCAL_WORLD_ALIGNED,
    OP_FRAME,
    POSITION,
    SENSOR,
    VELOCITY,
    WORLD,
)
from .explog import (  # noqa: F401
    Hlog3,
    Jexp3,
    Jexp6,
    Jlog3,
    Jlog6,
    alphaSkew,
    exp,
    exp3,
    exp3_quat,
    exp6,
    exp6_quat,
    log,
    log3,
    log6,
    log6_quat,
    skew,
    skewSquare,
    unSkew,
)
from .frames import Frame  # noqa: F401
from .friction import (  # noqa: F401
    CoulombFrictionCone,
    DualCoulombFrictionCone,
    StdVec_CoulombFrictionCone,
    StdVec_DualCoulombFrictionCone,
    computeContactImpulses,
    contactInverseDynamics,
)
from .geometry import (  # noqa: F401
    COLLISION,
    CollisionPair,
    GeometryData,
    GeometryModel,
    GeometryNoMaterial,
    GeometryObject,
    GeometryPhongMaterial,
    GeometryType,
    StdVec_CollisionPair,
    StdVec_GeometryObject,
    VISUAL,
)
from .hppfcl import (  # noqa: F401
    CachedMeshLoader,
    CollisionGeometry,
    CollisionRequest,
    CollisionResult,
    Contact,
    DistanceRequest,
    DistanceResult,
    MeshLoader,
    StdVec_CollisionResult,
    StdVec_Contact,
    StdVec_DistanceResult,
)
from .inertia import Inertia, LogCholeskyParameters, PseudoInertia  # noqa: F401
from .jacobians import (  # noqa: F401
    computeFrameJacobian,
    computeJointJacobian,
    computeJointJacobians,
    computeJointJacobiansTimeVariation,
    frameJacobianTimeVariation,
    getFrameJacobian,
    getFrameJacobianTimeVariation,
    getJointJacobian,
    getJointJacobianTimeVariation,
)
from .joint_data import JointData  # noqa: F401
from .joints import (  # noqa: F401
    JointModel,
    JointModelComposite,
    JointModelFreeFlyer,
    JointModelHX,
    JointModelHY,
    JointModelHZ,
    JointModelHelicalUnaligned,
    JointModelMimic,
    JointModelPX,
    JointModelPY,
    JointModelPZ,
    JointModelPlanar,
    JointModelPrismaticUnaligned,
    JointModelRUBX,
    JointModelRUBY,
    JointModelRUBZ,
    JointModelRX,
    JointModelRY,
    JointModelRZ,
    JointModelRevoluteUnaligned,
    JointModelRevoluteUnboundedUnaligned,
    JointModelSpherical,
    JointModelSphericalZYX,
    JointModelTranslation,
    JointModelUniversal,
)
from .kinematics import (  # noqa: F401
    forwardKinematics,
    framesForwardKinematics,
    getAcceleration,
    getClassicalAcceleration,
    getFrameAcceleration,
    getFrameClassicalAcceleration,
    getFrameVelocity,
    getVelocity,
    updateFramePlacement,
    updateFramePlacements,
    updateGlobalPlacements,
)
from .model import Model  # noqa: F401
from .parallel import ModelPool, abaInParallel, omp_get_max_threads, rneaInParallel  # noqa: F401
from .parsers import buildModelFromUrdf, buildModelFromXML  # noqa: F401
from .regressors import (  # noqa: F401
    bodyRegressor,
    computeFrameKinematicRegressor,
    computeJointKinematicRegressor,
    computeJointTorqueRegressor,
    computeKineticEnergyRegressor,
    computePotentialEnergyRegressor,
    computeStaticRegressor,
    frameBodyRegressor,
    jointBodyRegressor,
)
from .robot_wrapper import RobotWrapper  # noqa: F401
from .rotations import AngleAxis, Quaternion  # noqa: F401
from .sample_geometry import buildSampleGeometryModelHumanoid, buildSampleGeometryModelManipulator  # noqa: F401
from .samples import buildSampleModelHumanoid, buildSampleModelHumanoidRandom, buildSampleModelManipulator  # noqa: F401
from .serialization import (  # noqa: F401
    Serializable,
    StaticBuffer,
    StreamBuffer,
    buffer_copy,
    loadFromBinary,
    loadFromString,
    loadFromText,
    loadFromXML,
    saveToBinary,
    saveToString,
    saveToText,
    saveToXML,
)
from .shortcuts import buildModelsFromMJCF, buildModelsFromSdf, buildModelsFromUrdf, createDatas  # noqa: F401
from .spatial import Force, Motion, SE3, SE3ToXYZQUAT, SE3ToXYZQUATtuple, XYZQUATToSE3, classicAcceleration, skew  # noqa: F401
from .srdf import (  # noqa: F401
    loadReferenceConfigurations,
    loadReferenceConfigurationsFromXML,
    loadRotorParameters,
    removeCollisionPairs,
    removeCollisionPairsFromXML,
)
from .symmetric3 import Symmetric3  # noqa: F401
from .urdf_geometry import buildGeomFromUrdf, buildGeomFromUrdfString  # noqa: F401

__version__ = "3.7.0"
__raw_version__ = f"3.7.0, by libdyn {_version}"
PINOCCHIO_MAJOR_VERSION, PINOCCHIO_MINOR_VERSION, PINOCCHIO_PATCH_VERSION = 3, 7, 0
WITH_HPP_FCL = WITH_HPP_FCL_BINDINGS = WITH_URDFDOM = True
WITH_SDFORMAT = WITH_CPPAD = WITH_OPENMP = WITH_CASADI = False
XAxis, YAxis, ZAxis = _numpy.eye(3)
ScalarType = float


def printVersion(delimiter="."):
    """Returns the version of Pinocchio whose names are here."""
    return __version__.replace(".", delimiter)


def checkVersionAtLeast(major, minor, patch):
    """Returns whether the names here are those of at least this version of Pinocchio."""
    return (3, 7, 0) >= (major, minor, patch)


def __getattr__(name):
    return missing.find(name)
