#define ZWANG_ONCE template
#include <zwang/core/problem/eigen_once.h>
