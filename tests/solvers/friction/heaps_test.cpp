#include <gtest/gtest.h>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/core/referee/friction/numbers.h>
#include <zwang/solvers/registry.h>

namespace zwang {
namespace {

// Balls at rest, whose rows agree to 1e-13: the convex answer is Coulomb's, where the refreshed shift stalls.
TEST(ConeOnHeaps, BallsAtRestStayAtRest) {
  for (const char* scene : {"heap(balls=40)", "heap(balls=80)", "heap(balls=200)"}) {
    const Problem p = make_scenes(scene).at(0).problem;
    const Solution s = make_solver("cone").solve(p);
    ASSERT_EQ(s.status, Status::solved) << scene << ": " << s.message;
    EXPECT_LE((p.M * s.z).dot(s.z), 1e-24 * (p.M * p.z_u).dot(p.z_u)) << scene;
    // The referee's residuals alone: its proofs take minutes here.
    const ScaledProblem scaled(p);
    const ContactProblem contacts(p, scaled, scaled.norm_of_free_motion());
    const ExtendedVector lambda = contacts.multipliers(s.lambda);
    const ExtendedVector x = contacts.motion(s.z);
    EXPECT_LE(friction_residuals(contacts, p.law, x, &lambda).natural, 1e-12) << scene;
  }
}

}  // namespace
}  // namespace zwang
