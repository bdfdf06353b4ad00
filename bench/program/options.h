#pragma once

#include <optional>
#include <string>
#include <vector>

#include <zwang/core/problem/law.h>
#include <zwang/core/problem/range.h>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace zwang {

// What the options of all commands have in common, on top of CLI11.

// Name, column width and examples of `./zwang NAME --help`.
void introduce(CLI::App& app, const std::string& name, const std::string& examples);

// False after --help was printed. Throws std::invalid_argument with one line, the nearest option's name in it.
bool read(CLI::App& app, std::vector<std::string> words);

// --law frictionless|pyramid|convex|coulomb
void add_law(CLI::App& app, std::optional<Law>& law);
// The same, or several with commas between them
void add_laws(CLI::App& app, std::vector<Law>& laws);

inline const Range tolerances = between(0, 1);
// Refuses a number out of the range, which the option's line of help says.
CLI::Option* within(const Range& range, CLI::Option* option);

// "1e-2,1e-6" -> numbers. Throws std::invalid_argument.
std::vector<double> numbers(const std::string& option, const std::string& text);

}  // namespace zwang
