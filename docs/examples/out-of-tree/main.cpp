#include <zwang/bench/program/program.h>

#include "beads_scene.h"
#include "delassus_sweeps.h"

int main(int argc, char** argv) {
  return zwang::program(argc, argv,
                        {.solvers = {zwang::entry<DelassusSweeps>({.method = "Gauss-Seidel on the Delassus matrix",
                                                                   .limits = "dense; no infeasibility certificates",
                                                                   .sees_infeasibility = false})},
                         .scenes = {beads_scene}});
}
