// What a reader drops or guesses, for the report: each kind once, with its first place and how often.
#pragma once

#include "preprocess/read/read_text.h"

#include <string>
#include <string_view>
#include <vector>

namespace chamfer {

class ReadWarnings {
public:
  /// Counts one of a kind. `what` is text or a function that makes it: only the first of a kind is told. The
  /// place is "line 12: " for the mesh itself (`place.file` empty), "wood.mtl:12: " for other files, nothing
  /// without line and file.
  template <class What>
  void add(std::string_view kind, const TextPlace& place, const What& what) {
    if (Entry* known = find(kind)) {
      ++known->count;
    } else if constexpr (std::is_invocable_v<const What&>) {
      insert(kind, place, what());
    } else {
      insert(kind, place, what);
    }
  }

  /// The warnings in the order of their first places; at most kMost kinds, then "and N more".
  std::vector<std::string> texts() const;

  static constexpr std::size_t kMost = 20;

private:
  struct Entry {
    std::string kind, text;
    std::size_t count;
  };
  Entry* find(std::string_view kind);
  void insert(std::string_view kind, const TextPlace& place, const std::string& what);

  std::vector<Entry> entries_; ///< the first kMost kinds
  std::size_t further_ = 0;    ///< warnings of other kinds
};

} // namespace chamfer
