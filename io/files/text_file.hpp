#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/se3.hpp"

namespace motorcade {

/// A line of a text file, without its end, and its number counted from one.
struct TextLine {
  int number = 0;
  std::string text;
};

inline constexpr std::size_t kMaxText_bytes = std::size_t{1} << 30;

/// The treatment of a last line that has no line end. A program that was killed may have left half a line.
enum class LastLine { kKeep, kDropIfCut };

/// The lines of a file that are not blank. Accepts both line ends and a byte order mark. Throws InputError when the
/// file cannot be read or is larger than `limit_bytes`.
std::vector<TextLine> readLines(const std::filesystem::path& file, LastLine last_line = LastLine::kKeep,
                                std::size_t limit_bytes = kMaxText_bytes);

/// Reads the lines of a run's table, the first of which is its header, whose beginning is checked. A killed run may
/// have left a cut line, which is dropped, or no header in an empty file. Throws InputError.
std::vector<TextLine> readTableWithHeader(const std::filesystem::path& file, std::string_view header_start);
/// The same lines without the header.
std::vector<TextLine> readTable(const std::filesystem::path& file, std::string_view header_start);

/// The whole file; throws InputError when it cannot be read or is larger than `limit_bytes`.
std::string readWhole(const std::filesystem::path& file, std::size_t limit_bytes = kMaxText_bytes);

/// The beginning of a text from a file, safe for a message: no byte is a command to a terminal, and it fits into a
/// line.
std::string printable(std::string_view text, std::size_t most_characters = 40);

/// The text without the blanks around it.
std::string trimmed(std::string_view text);

/// Larger numbers are refused, so that squares of products stay finite.
inline constexpr double kLargestNumber = 1e50;

/// True for a rotation matrix, up to the digits that a file leaves off.
bool isRotation(const Eigen::Matrix3d& matrix);

/// Takes the fields of one line from left to right. Every failure is an InputError that names file and line.
class FieldReader {
 public:
  /// Creates a reader. A space separates by any run of blanks, any other character singly.
  FieldReader(const std::filesystem::path& file, const TextLine& line, char separator = ' ');

  std::string_view word(std::string_view what);
  double number(std::string_view what);
  /// The number in a field that may be empty.
  std::optional<double> numberOrNone(std::string_view what);
  std::int64_t integer(std::string_view what);
  /// The one of `values` that has this name.
  template <class Value, std::size_t N>
  Value byName(std::string_view what, const std::array<Value, N>& values, std::string_view (*name)(Value)) {
    const std::string_view text = word(what);
    const auto found = std::ranges::find(values, text, name);
    if (found == values.end()) fail(std::string(1, '\'').append(printable(text)).append("' is no ").append(what));
    return *found;
  }
  /// A pose of twelve numbers, row by row: R | t. R must be a rotation, and is put back onto SO(3) from its printed
  /// digits.
  SE3 pose(std::string_view what);
  bool atEnd() const { return rest_.empty() && !owes_field_; }
  /// Fails when fields are left.
  void expectEnd() const;
  [[noreturn]] void fail(const std::string& message) const;

 private:
  void skipBlanks();

  const std::filesystem::path& file_;
  int line_number_;
  std::string_view rest_;
  char separator_;
  bool owes_field_ = true;  // a separator was read: a field, if only an empty one, must follow
};

}  // namespace motorcade
