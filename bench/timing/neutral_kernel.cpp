#include <zwang/bench/timing/neutral_kernel.h>

#include <Eigen/QR>

namespace zwang {

double neutral_kernel_seconds() {
  struct Kernel {
    Matrix A = Matrix(96, 70);
    Eigen::HouseholderQR<Matrix> qr{96, 70};
    Kernel() {
      for (Index j = 0; j < 70; ++j)
        for (Index i = 0; i < 96; ++i) A(i, j) = static_cast<double>((7 * i * i + 13 * i * j + 29 * j) % 31) - 15;
      qr.compute(A);
    }
  };
  static Kernel kernel;
  constexpr int runs = 2;
  kernel.qr.compute(kernel.A);  // fills the caches
  const double start = thread_cpu_seconds();
  for (int i = 0; i < runs; ++i) kernel.qr.compute(kernel.A);
  return (thread_cpu_seconds() - start) / runs;
}

}  // namespace zwang
