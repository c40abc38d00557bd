#include "io/files/line_file.hpp"

#include "io/files/errors.hpp"

namespace motorcade {

void LineFile::writeLine(std::string_view line) {
  buffer_.assign(line);
  buffer_ += '\n';
  file_.write(buffer_);
}

void LineFile::writeLines(const std::vector<std::string>& lines) {
  buffer_.clear();
  for (const std::string& line : lines) buffer_.append(line) += '\n';
  file_.write(buffer_);
}

void replace(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::error_code error;
  std::filesystem::rename(from, to, error);
  if (error) throw OutputError(to.string() + ": cannot be written: " + error.message());
}

void writeAtOnce(const std::filesystem::path& file, std::string_view text) {
  std::string lines(text);
  if (!text.ends_with('\n')) lines += '\n';
  writeBytesAtOnce(file, lines);
}

void writeBytesAtOnce(const std::filesystem::path& file, std::string_view bytes) {
  std::filesystem::path unfinished = file;
  unfinished += kUnfinishedSuffix;
  try {
    OutputFile out(unfinished);
    out.write(bytes);
    out.close();
  } catch (const OutputError&) {
    std::error_code ignored;
    std::filesystem::remove(unfinished, ignored);
    throw;
  }
  replace(unfinished, file);
}

}  // namespace motorcade
