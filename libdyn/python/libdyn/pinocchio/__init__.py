# SPDX-License-Identifier: BSD-2-Clause
"""libdyn under the names of Pinocchio's Python module: import libdyn.pinocchio as pin.

Names, argument orders and results are those of Pinocchio 3.7. A Model may be changed at any time; it is compiled when an algorithm first needs it.
Data computes most of its fields when they are read. libdyn/doc/pinocchio.md says what differs and what is missing.
"""

import typing as _typing

import numpy as _numpy

from .. import ArgumentPosition as ArgumentPosition, ReferenceFrame as ReferenceFrame
from .. import __version__ as _version
from . import (
    cholesky as cholesky,
    hppfcl as hppfcl,
    liegroups as liegroups,
    linalg as linalg,
    missing as missing,
    rpy as rpy,
    utils as utils,
    visualize as visualize,
)
from ._random import seed as seed
from .centroidal import (
    ccrba as ccrba,
    computeCentroidalDynamicsDerivatives as computeCentroidalDynamicsDerivatives,
    computeCentroidalMap as computeCentroidalMap,
    computeCentroidalMapTimeVariation as computeCentroidalMapTimeVariation,
    computeCentroidalMomentum as computeCentroidalMomentum,
    computeCentroidalMomentumTimeVariation as computeCentroidalMomentumTimeVariation,
    dccrba as dccrba,
    getCentroidalDynamicsDerivatives as getCentroidalDynamicsDerivatives,
)
from .collision import (
    ComputeCollision as ComputeCollision,
    ComputeDistance as ComputeDistance,
    computeBodyRadius as computeBodyRadius,
    computeCollision as computeCollision,
    computeCollisions as computeCollisions,
    computeDistance as computeDistance,
    computeDistances as computeDistances,
    updateGeometryPlacements as updateGeometryPlacements,
)
from .com import (
    centerOfMass as centerOfMass,
    computeSubtreeMasses as computeSubtreeMasses,
    computeTotalMass as computeTotalMass,
    getJacobianSubtreeCenterOfMass as getJacobianSubtreeCenterOfMass,
    jacobianCenterOfMass as jacobianCenterOfMass,
    jacobianSubtreeCenterOfMass as jacobianSubtreeCenterOfMass,
)
from .configuration import (
    dDifference as dDifference,
    dIntegrate as dIntegrate,
    dIntegrateTransport as dIntegrateTransport,
    difference as difference,
    distance as distance,
    integrate as integrate,
    interpolate as interpolate,
    isNormalized as isNormalized,
    isSameConfiguration as isSameConfiguration,
    neutral as neutral,
    normalize as normalize,
    randomConfiguration as randomConfiguration,
    squaredDistance as squaredDistance,
)
from .constraints import (
    BaumgarteCorrectorParameters as BaumgarteCorrectorParameters,
    ProximalSettings as ProximalSettings,
    RigidConstraintData as RigidConstraintData,
    RigidConstraintModel as RigidConstraintModel,
    StdVec_RigidConstraintData as StdVec_RigidConstraintData,
    StdVec_RigidConstraintModel as StdVec_RigidConstraintModel,
    computeConstraintDynamicsDerivatives as computeConstraintDynamicsDerivatives,
    computeImpulseDynamicsDerivatives as computeImpulseDynamicsDerivatives,
    constraintDynamics as constraintDynamics,
    getConstraintJacobian as getConstraintJacobian,
    getConstraintsJacobian as getConstraintsJacobian,
    impulseDynamics as impulseDynamics,
    initConstraintDynamics as initConstraintDynamics,
)
from .contact import (
    computeKKTContactDynamicMatrixInverse as computeKKTContactDynamicMatrixInverse,
    forwardDynamics as forwardDynamics,
    getKKTContactDynamicMatrixInverse as getKKTContactDynamicMatrixInverse,
)
from .contact_cholesky import ContactCholeskyDecomposition as ContactCholeskyDecomposition
from .containers import (
    StdMap_String_VectorXd as StdMap_String_VectorXd,
    StdVec_Bool as StdVec_Bool,
    StdVec_Force as StdVec_Force,
    StdVec_Index as StdVec_Index,
    StdVec_IndexVector as StdVec_IndexVector,
    StdVec_Inertia as StdVec_Inertia,
    StdVec_Int as StdVec_Int,
    StdVec_MatrixXs as StdVec_MatrixXs,
    StdVec_Motion as StdVec_Motion,
    StdVec_SE3 as StdVec_SE3,
    StdVec_Scalar as StdVec_Scalar,
    StdVec_StdString as StdVec_StdString,
    StdVec_Symmetric3 as StdVec_Symmetric3,
    StdVec_Vector3 as StdVec_Vector3,
    StdVec_VectorXb as StdVec_VectorXb,
    StdVec_VectorXs as StdVec_VectorXs,
)
from .data import Data as Data
from .derivatives import (
    computeABADerivatives as computeABADerivatives,
    computeForwardKinematicsDerivatives as computeForwardKinematicsDerivatives,
    computeGeneralizedGravityDerivatives as computeGeneralizedGravityDerivatives,
    computeRNEADerivatives as computeRNEADerivatives,
    computeStaticTorqueDerivatives as computeStaticTorqueDerivatives,
    getCenterOfMassVelocityDerivatives as getCenterOfMassVelocityDerivatives,
    getFrameAccelerationDerivatives as getFrameAccelerationDerivatives,
    getFrameVelocityDerivatives as getFrameVelocityDerivatives,
    getJointAccelerationDerivatives as getJointAccelerationDerivatives,
    getJointVelocityDerivatives as getJointVelocityDerivatives,
    getPointClassicAccelerationDerivatives as getPointClassicAccelerationDerivatives,
    getPointVelocityDerivatives as getPointVelocityDerivatives,
)
from .dynamics import (
    aba as aba,
    computeAllTerms as computeAllTerms,
    computeCoriolisMatrix as computeCoriolisMatrix,
    computeGeneralizedGravity as computeGeneralizedGravity,
    computeKineticEnergy as computeKineticEnergy,
    computeMechanicalEnergy as computeMechanicalEnergy,
    computeMinverse as computeMinverse,
    computePotentialEnergy as computePotentialEnergy,
    computeStaticTorque as computeStaticTorque,
    crba as crba,
    getCoriolisMatrix as getCoriolisMatrix,
    nle as nle,
    nonLinearEffects as nonLinearEffects,
    rnea as rnea,
)
from .edit import (
    appendModel as appendModel,
    buildReducedModel as buildReducedModel,
    findCommonAncestor as findCommonAncestor,
    transformJointIntoMimic as transformJointIntoMimic,
)
from .enums import (
    ACCELERATION as ACCELERATION,
    ARG0 as ARG0,
    ARG1 as ARG1,
    BODY as BODY,
    CONTACT_3D as CONTACT_3D,
    CONTACT_6D as CONTACT_6D,
    ContactType as ContactType,
    Convention as Convention,
    FIXED_JOINT as FIXED_JOINT,
    FrameType as FrameType,
    JOINT as JOINT,
    KinematicLevel as KinematicLevel,
    LOCAL as LOCAL,
    LOCAL_WORLD_ALIGNED as LOCAL_WORLD_ALIGNED,
    OP_FRAME as OP_FRAME,
    POSITION as POSITION,
    SENSOR as SENSOR,
    VELOCITY as VELOCITY,
    WORLD as WORLD,
)
from .explog import (
    Hlog3 as Hlog3,
    Jexp3 as Jexp3,
    Jexp6 as Jexp6,
    Jlog3 as Jlog3,
    Jlog6 as Jlog6,
    alphaSkew as alphaSkew,
    exp as exp,
    exp3 as exp3,
    exp3_quat as exp3_quat,
    exp6 as exp6,
    exp6_quat as exp6_quat,
    log as log,
    log3 as log3,
    log6 as log6,
    log6_quat as log6_quat,
    skew as skew,
    skewSquare as skewSquare,
    unSkew as unSkew,
)
from .frames import Frame as Frame
from .friction import (
    CoulombFrictionCone as CoulombFrictionCone,
    DualCoulombFrictionCone as DualCoulombFrictionCone,
    StdVec_CoulombFrictionCone as StdVec_CoulombFrictionCone,
    StdVec_DualCoulombFrictionCone as StdVec_DualCoulombFrictionCone,
    computeContactImpulses as computeContactImpulses,
    contactInverseDynamics as contactInverseDynamics,
)
from .geometry import (
    COLLISION as COLLISION,
    CollisionPair as CollisionPair,
    GeometryData as GeometryData,
    GeometryModel as GeometryModel,
    GeometryNoMaterial as GeometryNoMaterial,
    GeometryObject as GeometryObject,
    GeometryPhongMaterial as GeometryPhongMaterial,
    GeometryType as GeometryType,
    StdVec_CollisionPair as StdVec_CollisionPair,
    StdVec_GeometryObject as StdVec_GeometryObject,
    VISUAL as VISUAL,
)
from .hppfcl import (
    CachedMeshLoader as CachedMeshLoader,
    CollisionGeometry as CollisionGeometry,
    CollisionRequest as CollisionRequest,
    CollisionResult as CollisionResult,
    Contact as Contact,
    DistanceRequest as DistanceRequest,
    DistanceResult as DistanceResult,
    MeshLoader as MeshLoader,
    StdVec_CollisionResult as StdVec_CollisionResult,
    StdVec_Contact as StdVec_Contact,
    StdVec_DistanceResult as StdVec_DistanceResult,
)
from .inertia import Inertia as Inertia, LogCholeskyParameters as LogCholeskyParameters, PseudoInertia as PseudoInertia
from .jacobians import (
    computeFrameJacobian as computeFrameJacobian,
    computeJointJacobian as computeJointJacobian,
    computeJointJacobians as computeJointJacobians,
    computeJointJacobiansTimeVariation as computeJointJacobiansTimeVariation,
    frameJacobianTimeVariation as frameJacobianTimeVariation,
    getFrameJacobian as getFrameJacobian,
    getFrameJacobianTimeVariation as getFrameJacobianTimeVariation,
    getJointJacobian as getJointJacobian,
    getJointJacobianTimeVariation as getJointJacobianTimeVariation,
)
from .joint_data import JointData as JointData
from .joints import (
    JointModel as JointModel,
    JointModelComposite as JointModelComposite,
    JointModelFreeFlyer as JointModelFreeFlyer,
    JointModelHX as JointModelHX,
    JointModelHY as JointModelHY,
    JointModelHZ as JointModelHZ,
    JointModelHelicalUnaligned as JointModelHelicalUnaligned,
    JointModelMimic as JointModelMimic,
    JointModelPX as JointModelPX,
    JointModelPY as JointModelPY,
    JointModelPZ as JointModelPZ,
    JointModelPlanar as JointModelPlanar,
    JointModelPrismaticUnaligned as JointModelPrismaticUnaligned,
    JointModelRUBX as JointModelRUBX,
    JointModelRUBY as JointModelRUBY,
    JointModelRUBZ as JointModelRUBZ,
    JointModelRX as JointModelRX,
    JointModelRY as JointModelRY,
    JointModelRZ as JointModelRZ,
    JointModelRevoluteUnaligned as JointModelRevoluteUnaligned,
    JointModelRevoluteUnboundedUnaligned as JointModelRevoluteUnboundedUnaligned,
    JointModelSpherical as JointModelSpherical,
    JointModelSphericalZYX as JointModelSphericalZYX,
    JointModelTranslation as JointModelTranslation,
    JointModelUniversal as JointModelUniversal,
)
from .kinematics import (
    forwardKinematics as forwardKinematics,
    framesForwardKinematics as framesForwardKinematics,
    getAcceleration as getAcceleration,
    getClassicalAcceleration as getClassicalAcceleration,
    getFrameAcceleration as getFrameAcceleration,
    getFrameClassicalAcceleration as getFrameClassicalAcceleration,
    getFrameVelocity as getFrameVelocity,
    getVelocity as getVelocity,
    updateFramePlacement as updateFramePlacement,
    updateFramePlacements as updateFramePlacements,
    updateGlobalPlacements as updateGlobalPlacements,
)
from .model import Model as Model
from .parallel import (
    ModelPool as ModelPool,
    abaInParallel as abaInParallel,
    omp_get_max_threads as omp_get_max_threads,
    rneaInParallel as rneaInParallel,
)
from .parsers import buildModelFromUrdf as buildModelFromUrdf, buildModelFromXML as buildModelFromXML
from .regressors import (
    bodyRegressor as bodyRegressor,
    computeFrameKinematicRegressor as computeFrameKinematicRegressor,
    computeJointKinematicRegressor as computeJointKinematicRegressor,
    computeJointTorqueRegressor as computeJointTorqueRegressor,
    computeKineticEnergyRegressor as computeKineticEnergyRegressor,
    computePotentialEnergyRegressor as computePotentialEnergyRegressor,
    computeStaticRegressor as computeStaticRegressor,
    frameBodyRegressor as frameBodyRegressor,
    jointBodyRegressor as jointBodyRegressor,
)
from .robot_wrapper import RobotWrapper as RobotWrapper
from .rotations import AngleAxis as AngleAxis, Quaternion as Quaternion
from .sample_geometry import (
    buildSampleGeometryModelHumanoid as buildSampleGeometryModelHumanoid,
    buildSampleGeometryModelManipulator as buildSampleGeometryModelManipulator,
)
from .samples import (
    buildSampleModelHumanoid as buildSampleModelHumanoid,
    buildSampleModelHumanoidRandom as buildSampleModelHumanoidRandom,
    buildSampleModelManipulator as buildSampleModelManipulator,
)
from .serialization import (
    Serializable as Serializable,
    StaticBuffer as StaticBuffer,
    StreamBuffer as StreamBuffer,
    buffer_copy as buffer_copy,
    loadFromBinary as loadFromBinary,
    loadFromString as loadFromString,
    loadFromText as loadFromText,
    loadFromXML as loadFromXML,
    saveToBinary as saveToBinary,
    saveToString as saveToString,
    saveToText as saveToText,
    saveToXML as saveToXML,
)
from .shortcuts import (
    buildModelsFromMJCF as buildModelsFromMJCF,
    buildModelsFromSdf as buildModelsFromSdf,
    buildModelsFromUrdf as buildModelsFromUrdf,
    createDatas as createDatas,
)
from .spatial import (
    Force as Force,
    Motion as Motion,
    SE3 as SE3,
    SE3ToXYZQUAT as SE3ToXYZQUAT,
    SE3ToXYZQUATtuple as SE3ToXYZQUATtuple,
    XYZQUATToSE3 as XYZQUATToSE3,
    classicAcceleration as classicAcceleration,
    skew as skew,
)
from .srdf import (
    loadReferenceConfigurations as loadReferenceConfigurations,
    loadReferenceConfigurationsFromXML as loadReferenceConfigurationsFromXML,
    loadRotorParameters as loadRotorParameters,
    removeCollisionPairs as removeCollisionPairs,
    removeCollisionPairsFromXML as removeCollisionPairsFromXML,
)
from .symmetric3 import Symmetric3 as Symmetric3
from .urdf_geometry import buildGeomFromUrdf as buildGeomFromUrdf, buildGeomFromUrdfString as buildGeomFromUrdfString

__version__ = "3.7.0"
__raw_version__ = f"3.7.0, by libdyn {_version}"
PINOCCHIO_MAJOR_VERSION, PINOCCHIO_MINOR_VERSION, PINOCCHIO_PATCH_VERSION = 3, 7, 0
WITH_HPP_FCL = WITH_HPP_FCL_BINDINGS = WITH_URDFDOM = True
WITH_SDFORMAT = WITH_CPPAD = WITH_OPENMP = WITH_CASADI = False
XAxis, YAxis, ZAxis = _numpy.eye(3)
ScalarType = float


def printVersion(delimiter: str = ".") -> str:
    """Returns the version of Pinocchio whose names are here."""
    return __version__.replace(".", delimiter)


def checkVersionAtLeast(major: int, minor: int, patch: int) -> bool:
    """Returns whether the names here are those of at least this version of Pinocchio."""
    return (3, 7, 0) >= (major, minor, patch)


if not _typing.TYPE_CHECKING:  # type checkers refuse what is not here

    def __getattr__(name):
        return missing.find(name)
