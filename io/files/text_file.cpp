#include "io/files/text_file.hpp"

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>

#include <Eigen/LU>
#include <unistd.h>

#include "io/files/errors.hpp"
#include "io/files/file_descriptor.hpp"

namespace motorcade {

std::vector<TextLine> readTableWithHeader(const std::filesystem::path& file, std::string_view header_start) {
  auto lines = readLines(file, LastLine::kDropIfCut);
  if (lines.empty()) return lines;
  if (!lines.front().text.starts_with(header_start)) {
    throw InputError(file.string() + ", line " + std::to_string(lines.front().number) +
                     ": the header must begin with " + std::string(header_start));
  }
  return lines;
}

std::vector<TextLine> readTable(const std::filesystem::path& file, std::string_view header_start) {
  auto lines = readTableWithHeader(file, header_start);
  if (!lines.empty()) lines.erase(lines.begin());
  return lines;
}

std::string readWhole(const std::filesystem::path& file, std::size_t limit_bytes) {
  const InputFile in = openInput(file);
  if (in.bytes > limit_bytes)
    throw InputError(file.string() + ": is too large (" + std::to_string(in.bytes) + " bytes, at most " +
                     std::to_string(limit_bytes) + ")");
  std::string content(in.bytes, '\0');
  std::size_t done = 0;
  while (done < content.size()) {
    const ssize_t got = ::read(in.descriptor.number(), content.data() + done, content.size() - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw InputError(file.string() + ": cannot be read: " + std::strerror(errno));
    if (got == 0) break;  // it was cut meanwhile
    done += static_cast<std::size_t>(got);
  }
  content.resize(done);
  return content;
}

std::vector<TextLine> readLines(const std::filesystem::path& file, LastLine last_line, std::size_t limit_bytes) {
  const std::string content = readWhole(file, limit_bytes);
  std::string_view rest = content;
  if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);
  std::vector<TextLine> lines;
  for (int number = 1; !rest.empty(); ++number) {
    const auto end = rest.find('\n');
    if (end == std::string_view::npos && last_line == LastLine::kDropIfCut) break;
    std::string_view text = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    if (text.ends_with('\r')) text.remove_suffix(1);
    if (text.find_first_not_of(" \t") != std::string_view::npos) lines.push_back({number, std::string(text)});
  }
  return lines;
}

std::string printable(std::string_view text, std::size_t most_characters) {
  std::string shown(text.substr(0, most_characters));
  std::ranges::replace_if(
      shown, [](unsigned char c) { return c < ' ' || c > '~'; }, '?');
  if (text.size() > most_characters) shown += "...";
  return shown;
}

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(" \t") + 1 - first));
}

bool isRotation(const Eigen::Matrix3d& matrix) {
  constexpr double kMaxDeviation = 1e-3;  // files with few digits are accepted, matrices that are no rotation are not
  return (matrix * matrix.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= kMaxDeviation &&
         matrix.determinant() > 0;
}

FieldReader::FieldReader(const std::filesystem::path& file, const TextLine& line, char separator)
    : file_(file), line_number_(line.number), rest_(line.text), separator_(separator) {
  skipBlanks();
  if (separator_ == ' ') owes_field_ = false;
}

void FieldReader::skipBlanks() {
  if (separator_ != ' ') return;
  const auto start = rest_.find_first_not_of(" \t");
  rest_.remove_prefix(start == std::string_view::npos ? rest_.size() : start);
}

std::string_view FieldReader::word(std::string_view what) {
  if (atEnd()) fail("ends before " + printable(what));
  const auto end = separator_ == ' ' ? rest_.find_first_of(" \t") : rest_.find(separator_);
  const std::string_view field = rest_.substr(0, end);
  owes_field_ = separator_ != ' ' && end != std::string_view::npos;
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  skipBlanks();
  return field;
}

double FieldReader::number(std::string_view what) {
  std::string_view field = word(what);
  const std::string_view shown = field;
  if (field.starts_with('+')) field.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size())
    fail("'" + printable(shown) + "' is not a number (" + printable(what) + ")");
  if (!std::isfinite(value)) fail("'" + printable(shown) + "' is not finite (" + printable(what) + ")");
  if (std::abs(value) > kLargestNumber) fail("'" + printable(shown) + "' is too large (" + printable(what) + ")");
  return value;
}

std::optional<double> FieldReader::numberOrNone(std::string_view what) {
  if (atEnd() || !(rest_.empty() || rest_.front() == separator_)) return number(what);
  word(what);
  return std::nullopt;
}

std::int64_t FieldReader::integer(std::string_view what) {
  const std::string_view field = word(what);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size()) {
    fail("'" + printable(field) + "' is not a whole number (" + printable(what) + ")");
  }
  return value;
}

SE3 FieldReader::pose(std::string_view what) {
  Eigen::Matrix<double, 3, 4> m;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) m(row, column) = number(what);
  const Eigen::Matrix3d rotation = m.leftCols<3>();
  if (!isRotation(rotation)) fail(std::string(what) + " holds no rotation matrix");
  return SE3(rotation, m.col(3)).normalized();
}

void FieldReader::expectEnd() const {
  if (!atEnd()) fail("has more fields than expected: '" + printable(rest_) + "'");
}

void FieldReader::fail(const std::string& message) const {
  throw InputError(file_.string() + ", line " + std::to_string(line_number_) + ": " + message);
}

}  // namespace motorcade
