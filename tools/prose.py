#!/usr/bin/python3
"""Measures how long the sentences of the documents are and how doc comments begin, and fails where they are out of bounds.

  tools/prose.py              the documents and headers of this repository; names the longest sentences of a document that is out of bounds
  tools/prose.py FILE...      only prints the words of a sentence in these files: median, 90th percentile, most

Tables, code blocks, headings, pictures and HTML are left out. An item of a list is a paragraph, and inline code is one word.
"""
import os
import pathlib
import re
import statistics
import sys

GUIDES = ["README.md", "CONTRIBUTING.md", "SECURITY.md", "docs/guide_*.md", "docs/bridge.md", "docs/view.md", "docs/glossary.md",
          "docs/install.md", "docs/paper.md", "docs/results.md", "docs/formats.md", "docs/scaling.md", "docs/decisions/*.md",
          "perf/*.md", "examples/*/*.md"]
DESIGN = ["docs/design.md"]
# What is measured: documents, most words of a sentence in the median, and at the 90th percentile.
BOUNDS = [(GUIDES, 20, 34), (DESIGN, 22, None)]
# The share of doc comments in headers, in percent, that may begin with a preposition or conjunction. To be lowered as they are rewritten.
MOST_LATE_SUBJECTS = 3.0
LATE_SUBJECTS = set("""about above across after against along although among and around as at because before behind below beneath beside besides
between beyond but by despite during except for from how if in inside into like near of off on onto or out outside over per since so than that though
through throughout till to toward towards under unless until upon what when whenever where wherever whether which while who whose why with within
without""".split())

ABBREVIATION = re.compile(r"\b(?:e\.g|i\.e|et al|vs|cf|no|fig|eq|sec)\.$", re.IGNORECASE)
SENTENCE_END = re.compile(r"[.!?][)\"'*_]*(?=\s+[\"'(*_`]*[A-Z0-9`*]|\s*$)")


def plain(line):
    line = re.sub(r"!\[[^\]]*\]\([^)]*\)", "", line)
    line = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", line)
    return re.sub(r"`[^`]+`", "`code`", line)


def paragraphs(text):
    """Yields each paragraph and each item of a list, as a list of (line number, words of the line)."""
    lines = []
    fenced = False
    for number, line in enumerate(text.splitlines() + [""], 1):
        stripped = line.strip()
        if stripped.startswith("```"):
            fenced, stripped = not fenced, ""
        elif fenced or stripped.startswith(("|", "#", "<", "![", ">", "---")):
            stripped = ""
        item = re.match(r"(?:[*+-]|\d+\.)\s+", stripped)
        if (item or not stripped) and lines:
            yield lines
            lines = []
        if stripped:
            lines.append((number, plain(stripped[item.end():] if item else stripped)))


def sentences(text):
    """Yields (number of its first line, count of words, sentence)."""
    for lines in paragraphs(text):
        whole = " ".join(line for _, line in lines)
        begin = 0
        for end in [m.end() for m in SENTENCE_END.finditer(whole)] + [len(whole)]:
            sentence = whole[begin:end].strip()
            if ABBREVIATION.search(sentence) and end < len(whole):
                continue
            count = sum(bool(re.search(r"\w", word)) for word in sentence.split())
            if count > 1:
                yield line_of(begin + 1, lines), count, sentence
            begin = end


def line_of(offset, lines):
    for number, line in lines:
        offset -= len(line) + 1
        if offset < 0:
            return number
    return lines[-1][0]


def quantile(values, share):
    ordered = sorted(values)
    return ordered[int(share * (len(ordered) - 1))] if ordered else 0


def first_words(header):
    """Yields the first word of each doc comment, which is a block of lines that begin with ///."""
    inside = False
    for line in header.splitlines():
        found = re.match(r"\s*///[\W_]*(\w*)", line)
        if found and not inside:
            yield found[1].lower()
        inside = bool(found)


def measure(text):
    """Returns the median and 90th percentile of the words of a sentence, and all sentences, the longest first."""
    found = sorted(((count, line, sentence) for line, count, sentence in sentences(text)), reverse=True)
    counts = [count for count, _, _ in found] or [0]
    return statistics.median(counts), quantile(counts, 0.9), found


def check_documents(root):
    failed = False
    for patterns, most_median, most_p90 in BOUNDS:
        for file in sorted(path for pattern in patterns for path in root.glob(pattern)):
            median, p90, found = measure(file.read_text(encoding="utf-8"))
            bad = median > most_median or (most_p90 is not None and p90 > most_p90)
            failed |= bad
            name = file.relative_to(root)
            limit = f"{most_median}" + (f" and {most_p90}" if most_p90 else "")
            print(f"{str(name):28} words of a sentence: median {median:g}, 90 % {p90} (at most {limit})")
            for count, line, sentence in found[:10] if bad else []:
                print(f"  {name}:{line}: {count} words: {sentence[:100]}")
    return failed


def headers(root):
    """Yields the headers of a checkout or of a source package, without what was built."""
    for folder, inside, names in os.walk(root):
        inside[:] = sorted(name for name in inside if name != "build" and not name.startswith("."))
        yield from (pathlib.Path(folder) / name for name in sorted(names) if name.endswith((".hpp", ".h")))


def check_doc_comments(root):
    words = [word for header in headers(root) for word in first_words(header.read_text(encoding="utf-8"))]
    share = 100 * sum(word in LATE_SUBJECTS for word in words) / max(1, len(words))
    print(f"{share:.2f} % of {len(words)} doc comments in headers begin with a preposition or conjunction (at most {MOST_LATE_SUBJECTS} %)")
    return share > MOST_LATE_SUBJECTS


def check(root):
    """Whether something is out of bounds."""
    failed = check_documents(root)
    return check_doc_comments(root) or failed


def main():
    if len(sys.argv) > 1:
        for name in sys.argv[1:]:
            median, p90, found = measure(pathlib.Path(name).read_text(encoding="utf-8"))
            most = found[0][0] if found else 0
            print(f"{name}: {len(found)} sentences, words of a sentence: median {median:g}, 90 % {p90}, most {most}")
        return 0
    return 1 if check(pathlib.Path(__file__).resolve().parent.parent) else 0


if __name__ == "__main__":
    sys.exit(main())
