#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

/// Parts of self-contained HTML pages: they load no script, font or picture from elsewhere.
namespace motorcade {

/// Escapes the text of an element or the value of a quoted attribute; control characters become U+FFFD.
std::string escaped(std::string_view text);

std::string base64(std::span<const std::byte> bytes);
std::string base64(std::string_view bytes);

/// URI for `src` of an image; `mime` such as "image/png".
std::string dataUri(std::string_view mime, std::string_view bytes);

/// A whole page; `title` is escaped, `body` and `extra_style` (CSS rules after the base style) go in as they are.
///
/// The base style follows the reader's light or dark, fits a phone, prints, and gives
///   colors       var(--page | --ink | --muted | --rule | --card | --accent | --good | --warn | --bad)
///   .cards       a grid of .card, each with a .value and a .label
///   .badge       a short word on a plate: .good, .warn or .bad
///   .number      right-aligned digits of one width, of th and td
///   .wide        around a table or picture that scrolls sideways where it does not fit, with a shadow where there is
///                more; on a ground of another color than the page's, --under names that
///   .swipe       a sentence below it that only narrow screens show
///   .muted       less important text
///   .finding     a boxed message with a colored edge: .good, .warn or .bad
///   .keep        is not cut between two printed pages (figures and cards are not either)
std::string htmlPage(std::string_view title, std::string_view body, std::string_view extra_style = "");

}  // namespace motorcade
