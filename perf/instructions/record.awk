# Holds counts ("DRIVE STAGE INSTRUCTIONS" per line, separated by tabs) against the record, a page with a section of its name for each drive and
# in it a table: | stage | instructions per frame | units | budget |. A unit is what libpng takes for a pair of the same drive.
#   awk -f record.awk -v mode=check COUNTS RECORD   ends with 1 where a stage grew by more than 5 % or has no room left in its budget
#   awk -f record.awk -v mode=write COUNTS RECORD   prints the page with the counts in it, and with -v budgets=yes with new budgets
# The lines "conditions NAME VALUE" of COUNTS belong to the section "conditions".
BEGIN {
  FS = "\t"
  most_growth = .05  # counts repeat to a hundredth of that
  room = .08         # of a new budget
}
function number(text) { gsub(/[ ,]/, "", text); return text + 0 }
function with_commas(value,   text, out) {
  text = sprintf("%.0f", value)
  while (length(text) > 3) { out = "," substr(text, length(text) - 2) out; text = substr(text, 1, length(text) - 3) }
  return text out
}
function cell(text) { gsub(/^ +| +$/, "", text); return text }
function unit() { return count[drive, "libpng"] }
function units(value) { return unit() ? value / unit() : 0 }
function has_budget(stage) { return stage != "libpng" && stage != "rest" && stage != "all" }
function new_budget(value,   thousandths) { thousandths = units(value) * (1 + room) * 1000; return int(thousandths + 1) / 1000 }

function write_row(stage, budget,   value) {
  value = count[drive, stage]
  if (budgets && has_budget(stage)) budget = sprintf("%.3f", new_budget(value))
  printf "| %s | %s | %.3f | %s|\n", stage, with_commas(value), units(value), budget == "" ? "" : budget " "
}

function fail(what) { print "FAILED " drive ": " what; failed = 1 }
function check_row(stage, recorded, budget,   value, growth) {
  value = count[drive, stage]
  growth = recorded ? value / recorded - 1 : 1
  printf "%-20s %-25s %13s %13s %+7.2f %%  %7.3f units %s\n", drive, stage, with_commas(recorded), with_commas(value), 100 * growth,
    units(value), budget == "" ? "" : "of " budget
  if (!has_budget(stage)) return
  ++checked
  if (growth > most_growth)
    fail(sprintf("%s takes %s instructions per frame, %.1f %% more than the %s of perf/instructions.md. Make it cheaper, or run perf/instructions.sh --write and say why in the commit.",
      stage, with_commas(value), 100 * growth, with_commas(recorded)))
  if (budget == "") fail(stage " has no budget: run perf/instructions.sh --write --budgets")
  else if (units(value) > budget + 0)
    fail(sprintf("%s takes %.3f units, more than its budget of %s. Make it cheaper; a larger budget is a decision: change it in perf/instructions.md and say why in the commit.", stage, units(value), budget))
  if (growth < -most_growth)
    print "NOTE " drive ": " stage sprintf(" fell by %.1f %%: perf/instructions.sh --write --budgets holds that.", -100 * growth)
}

NR == FNR { count[$1, $2] = $3; counted[$1]; pending[$1, $2]; next }
/^## / { drive = substr($0, 4) }
{
  cells = split($0, row, "|")
  stage = cell(row[2])
  if (cells < 4 || !((drive, stage) in count)) { if (mode == "write") print; next }
  delete pending[drive, stage]
  if (drive == "conditions") { if (mode == "write") print "| " stage " | " count[drive, stage] " |" }
  else if (mode == "write") write_row(stage, cell(row[5]))
  else check_row(stage, number(row[3]), cell(row[5]))
}
END {
  for (key in pending) {
    split(key, names, SUBSEP)
    print names[1] ": the record has no row for " names[2] > "/dev/stderr"
    failed = 1
  }
  if (mode == "check" && !failed) print checked + 0 " counts hold"
  exit failed
}
