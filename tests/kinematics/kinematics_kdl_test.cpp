// The kinematics of the simulated arms against orocos-kdl: chains put together from the numbers of
// docs/yaskawa-protocols section 5 (not from ours), its forward solver, and its numeric inverse against our closed
// form.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#include <random>
#include <string>

#include "pickcell/core/units.hpp"
#include "pickcell/sim/kinematics.hpp"

namespace pickcell::sim {
namespace {

struct Links {
  ArmModel model;
  double s_to_l_x_mm, l_to_u_z_mm, u_to_b_x_mm, u_to_b_z_mm, b_to_flange_mm;
};

constexpr Links kLinks[] = {{ArmModel::motomini, 20, 165, 165, 0, 40},
                            {ArmModel::gp7, 40, 445, 440, 40, 80},
                            {ArmModel::gp8, 40, 345, 340, 40, 80}};

/// Every axis turns about a line fixed at zero: S +z, L +y, U -y, R -x, B -y, T -x. MotoMINI stands with its flange
/// down at zero and turns T about +z; the others point it forward.
KDL::Chain chain_of(const Links& links) {
  using KDL::Frame;
  using KDL::Joint;
  using KDL::Vector;
  const bool mini = links.model == ArmModel::motomini;
  const Vector l(links.s_to_l_x_mm / 1e3, 0, 0);
  const Vector u(0, 0, links.l_to_u_z_mm / 1e3);
  const Vector b(links.u_to_b_x_mm / 1e3, 0, links.u_to_b_z_mm / 1e3);
  const double tool_m = links.b_to_flange_mm / 1e3;
  const Vector flange = mini ? Vector(0, 0, -tool_m) : Vector(tool_m, 0, 0);
  // Z out of the flange; forward: X up.
  const KDL::Rotation turned = mini ? KDL::Rotation::RotX(KDL::PI) : KDL::Rotation::RPY(KDL::PI, -KDL::PI / 2, 0);
  const Vector none = Vector::Zero();
  KDL::Chain chain;
  const auto add = [&](const Vector& axis, const Frame& to_next) {
    chain.addSegment(KDL::Segment(Joint(none, axis, Joint::RotAxis), to_next));
  };
  add(Vector(0, 0, 1), Frame(l));
  add(Vector(0, 1, 0), Frame(u));
  add(Vector(0, -1, 0), Frame(b));
  add(Vector(-1, 0, 0), Frame(none));
  add(Vector(0, -1, 0), Frame(none));
  add(mini ? Vector(0, 0, 1) : Vector(-1, 0, 0), Frame(turned, flange));
  return chain;
}

KDL::JntArray array_of(const Joints& q) {
  KDL::JntArray out(6);
  out.data = q;
  return out;
}

/// Largest difference of any element, metres and rotation matrix alike.
double away(const KDL::Frame& theirs, const FlangePose& ours) {
  double most = 0;
  for (int row = 0; row < 3; ++row) {
    most = std::max(most, std::abs(theirs.p(row) - ours.translation_m()(row)));
    for (int column = 0; column < 3; ++column)
      most = std::max(most, std::abs(theirs.M(row, column) - ours.rotation()(row, column)));
  }
  return most;
}

Joints random_joints(const Arm& a, std::mt19937& random) {
  Joints q;
  for (int i = 0; i < 6; ++i) q[i] = std::uniform_real_distribution(a.lower[i], a.upper[i])(random);
  return q;
}

class AgainstKdl : public ::testing::TestWithParam<Links> {};

TEST_P(AgainstKdl, TheFlangeIsAtTheSamePlaceForAnyJoints) {
  const Arm& a = arm(GetParam().model);
  const KDL::Chain chain = chain_of(GetParam());
  KDL::ChainFkSolverPos_recursive solver(chain);
  std::mt19937 random(20);
  for (int i = 0; i < 10000; ++i) {
    const Joints q = random_joints(a, random);
    KDL::Frame frame;
    ASSERT_GE(solver.JntToCart(array_of(q), frame), 0);
    ASSERT_LT(away(frame, forward(a, q)), 1e-12) << q.transpose();
  }
}

/// Wherever the numeric solver ends, the closed form knows that way: no branch is missing, none is wrong.
TEST_P(AgainstKdl, EveryWayThatANumericSolverFindsIsAmongOurs) {
  const Arm& a = arm(GetParam().model);
  const KDL::Chain chain = chain_of(GetParam());
  KDL::ChainFkSolverPos_recursive forward_solver(chain);
  KDL::ChainIkSolverPos_LMA solver(chain, 1e-9, 300);
  std::mt19937 random(21);
  int found = 0;
  for (int i = 0; i < 1000; ++i) {
    const FlangePose target = forward(a, random_joints(a, random));
    KDL::Frame frame;
    for (int row = 0; row < 3; ++row) {
      frame.p(row) = target.translation_m()(row);
      for (int column = 0; column < 3; ++column) frame.M(row, column) = target.rotation()(row, column);
    }
    KDL::JntArray theirs(6);
    if (solver.CartToJnt(array_of(random_joints(a, random)), frame, theirs) < 0) continue;  // a numeric solver may fail
    ASSERT_GE(forward_solver.JntToCart(theirs, frame), 0);
    if (away(frame, target) > 1e-7) continue;
    ++found;
    const Joints way = theirs.data;
    double nearest = 10;
    for (const Joints& ours : inverse(a, target, way)) nearest = std::min(nearest, (ours - way).cwiseAbs().maxCoeff());
    EXPECT_LT(nearest, 1e-3) << "theirs " << way.transpose();
  }
  EXPECT_GT(found, 500);
}

INSTANTIATE_TEST_SUITE_P(Arms, AgainstKdl, ::testing::ValuesIn(kLinks),
                         [](const auto& tested) { return std::string(name(tested.param.model)); });

}  // namespace
}  // namespace pickcell::sim
