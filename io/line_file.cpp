#include "io/line_file.hpp"

#include "io/errors.hpp"

namespace motorcade {

void LineFile::writeLine(std::string_view line) {
  buffer_.assign(line);
  buffer_ += '\n';
  file_.write(buffer_);
}

void replace(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::error_code error;
  std::filesystem::rename(from, to, error);
  if (error) throw OutputError(to.string() + ": cannot be written: " + error.message());
}

void writeAtOnce(const std::filesystem::path& file, std::string_view content) {
  std::filesystem::path unfinished = file;
  unfinished += ".part";
  try {
    LineFile out(unfinished);
    if (content.ends_with('\n')) content.remove_suffix(1);
    out.writeLine(content);
    out.close();
  } catch (const OutputError&) {
    std::error_code ignored;
    std::filesystem::remove(unfinished, ignored);
    throw;
  }
  replace(unfinished, file);
}

}  // namespace motorcade
