#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <zwang/core/problem/law.h>

namespace CLI {
class App;
}

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

// For Option::check: "" when the text is a finite number from low to high, or above low; else what is expected.
using Check = std::function<std::string(const std::string& text)>;
Check from_to(double low, double high = std::numeric_limits<double>::infinity());
Check above(double low);

// "1e-2,1e-6" -> numbers. Throws std::invalid_argument.
std::vector<double> numbers(const std::string& option, const std::string& text);

}  // namespace zwang
