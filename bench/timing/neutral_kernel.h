#pragma once

namespace zwang {

// One run of a kernel that no solver here contains, built with the same flags: Eigen's HouseholderQR of a fixed 96 x 70
// matrix (a hand has 96 unknowns and 70 joint rows). A time over its time, taken in the same interleaved sequence,
// compares between machines and hours as no microseconds do. Seconds of thread CPU time, the mean of two.
double neutral_kernel_seconds();

}  // namespace zwang
