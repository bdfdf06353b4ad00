#pragma once

#include <map>
#include <utility>
#include <vector>

namespace zwang::report {

// A map whose items stand in the order in which their keys first came.
template <class Key, class Value>
struct InOrder {
  std::vector<std::pair<Key, Value>> items = {};
  std::map<Key, std::size_t> place = {};

  Value& operator[](const Key& key) {
    const auto [it, fresh] = place.try_emplace(key, items.size());
    if (fresh) items.emplace_back(key, Value());
    return items[it->second].second;
  }
};

}  // namespace zwang::report
