#pragma once

#include <string_view>

// Puts a file into the program: defines `std::string_view NAME()`, its bytes. PATH: a string literal.
#define ZWANG_EMBEDDED(NAME, PATH)                                                                                     \
  asm(".pushsection .rodata\n.global embedded_" #NAME ", embedded_" #NAME "_end\nembedded_" #NAME ":\n.incbin \"" PATH \
      "\"\nembedded_" #NAME "_end:\n.byte 0\n.popsection\n");                                                          \
  extern "C" const char embedded_##NAME[], embedded_##NAME##_end[];                                                    \
  static std::string_view NAME() { return {embedded_##NAME, embedded_##NAME##_end}; }
