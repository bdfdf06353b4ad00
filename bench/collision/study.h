#pragma once

#include <cstddef>
#include <map>
#include <string>

namespace zwang {

// A finger (a capsule) over a bumpy sphere, and motions of 1 mm that start at one gap from it, asked of every method:
// zwang, fcl, bullet.
struct PairStudy {
  std::size_t triangles = 0;
  double gap = 0;  // m
  std::string motion;
  int placements = 0;
  std::map<std::string, double> times = {}, p95 = {};  // s, medians and 95th percentiles of cold queries
  std::map<std::string, double> stops = {};            // m, mean gap where a motion that is stopped ends
  std::map<std::string, int> hits = {};
  int true_hits = 0;
  double smallest_gap = 1;  // m, after our motions
};
// motion: "pressing", "sliding", "passing".
PairStudy study_pairs(std::size_t triangles, double gap, const std::string& motion, int count);

}  // namespace zwang
