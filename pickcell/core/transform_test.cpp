#include "pickcell/core/transform.hpp"

#include <gtest/gtest.h>

#include <type_traits>

#include "pickcell/core/units.hpp"

namespace pickcell::core {
namespace {

template <class A, class B>
concept Composable = requires(A a, B b) { a* b; };

TEST(Transform, WrongOrderDoesNotCompile) {
  static_assert(Composable<Transform<Base, Camera>, Transform<Camera, Board>>);
  static_assert(!Composable<Transform<Camera, Board>, Transform<Base, Camera>>);
  static_assert(!Composable<Transform<Base, Camera>, Point<Base>>);
}

TEST(Transform, InverseUndoes) {
  const Transform<Base, Camera> T(rotation_z(0.3), {1, 2, 3});
  EXPECT_TRUE((T.inverse() * T).iso().isApprox(Eigen::Isometry3d::Identity()));
  EXPECT_TRUE((T * Point<Camera>{{1, 0, 0}}).m.isApprox(Eigen::Vector3d(1 + std::cos(.3), 2 + std::sin(.3), 3)));
}

TEST(Units, WrapIsHalfOpen) {
  EXPECT_DOUBLE_EQ(wrap_deg(-180), 180);
  EXPECT_DOUBLE_EQ(wrap_deg(540), 180);
  EXPECT_DOUBLE_EQ(wrap_deg(-190), 170);
  EXPECT_DOUBLE_EQ(wrap_rad(3 * kPi), kPi);
}

}  // namespace
}  // namespace pickcell::core
