#pragma once

#include <memory>

namespace zwang {

// What is kept between solves, of a type that only one .cpp knows, such as a library's state. A copy starts without it,
// as a solver's workspace may.
template <class T>
class Session {
 public:
  Session() = default;
  Session(const Session&) {}
  Session& operator=(const Session& other) {
    if (this != &other) state_.reset();
    return *this;
  }

  template <class... Arguments>
  T& open(Arguments&&... arguments) {
    if (!state_) state_ = std::make_shared<T>(std::forward<Arguments>(arguments)...);
    return *state_;
  }
  explicit operator bool() const { return state_ != nullptr; }
  T& operator*() const { return *state_; }
  T* operator->() const { return state_.get(); }

 private:
  std::shared_ptr<T> state_;
};

}  // namespace zwang
