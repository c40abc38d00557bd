#!/usr/bin/python3
"""Tests tools/prose.py on small texts that are written here."""
import contextlib
import importlib.util
import io
import pathlib
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent / "tools/prose.py"
spec = importlib.util.spec_from_file_location("prose", SOURCE)
prose = importlib.util.module_from_spec(spec)
spec.loader.exec_module(prose)

TEXT = """# A heading that does not count.

Two short sentences stand here. The second
runs over [two lines](a.md) and ends at 2.5 m.

| a table | does not count. Nor does this. |

* An item says `run --out DIR now` once
* et al. (2016) is no end of one.

```sh
no code. No words.
```
"""


class Prose(unittest.TestCase):
    def test_sentences_are_those_of_paragraphs_and_items(self):
        self.assertEqual([(3, 5), (3, 11), (8, 5), (9, 8)], [(line, count) for line, count, _ in prose.sentences(TEXT)])

    def test_a_doc_comment_counts_once_by_its_first_word(self):
        header = "/// Of the first,\n/// with a second line.\nint a;\n  /// `Points` of a track.\n// With two slashes.\n"
        self.assertEqual(["of", "points"], list(prose.first_words(header)))

    def test_a_document_and_headers_out_of_bounds_fail_and_are_named(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "README.md").write_text("\n\nShort is good here.\n\n" + "word " * 40 + ".\n", encoding="utf-8")
            (root / "a.hpp").write_text("/// Points of a track.\n", encoding="utf-8")
            (root / "build").mkdir()
            (root / "build" / "generated.hpp").write_text("/// With a preposition.\n", encoding="utf-8")
            said = io.StringIO()
            with contextlib.redirect_stdout(said):
                self.assertTrue(prose.check(root))  # the median of 4 and 40 is above 20
                (root / "README.md").write_text("Short is good here.\n", encoding="utf-8")
                self.assertFalse(prose.check(root))
                (root / "a.hpp").write_text("/// With a preposition.\n", encoding="utf-8")
                self.assertTrue(prose.check(root))
            self.assertIn("README.md:5: 40 words", said.getvalue())


if __name__ == "__main__":
    unittest.main()
