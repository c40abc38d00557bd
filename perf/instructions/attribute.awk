# From a profile by callgrind to what a frame costs in each stage, a line "DRIVE STAGE INSTRUCTIONS" each, separated by tabs. A stage's
# instructions are those of the function that the wiring calls, and of all that it calls: with one worker its loops run in there, too.
# Fails where such a function was not called as often as there are frames.
#   awk -f attribute.awk -v drive=NAME -v frames=N -v parts=stages|libpng PROFILE
function part(name, prefix, calls) { order[++count] = name; prefix_of[name] = prefix; expected[name] = calls }
function stage(name, member) { part(name, "motorcade::StageRunner::" member "(motorcade::Job&)", frames) }
function line(name, instructions) { printf "%s\t%s\t%.0f\n", drive, name, instructions / frames }
function complain(what) { print drive ": " what > "/dev/stderr"; failed = 1 }

BEGIN {
  if (parts == "libpng") part("libpng", "motorcade::decodeAnyPng(", 2 * frames)
  else {
    part("decoding", "motorcade::PairReader::read(", 2 * frames)
    part("input check", "motorcade::RigWatch::observe(", frames)
    stage("prepare", "prepare")
    stage("stereo matching", "matchStereo")
    stage("optical flow", "trackFlow")
    stage("scene flow segmentation", "segmentSceneFlow")
    stage("tracking", "trackObjects")
    stage("incremental optimization", "optimize")
    stage("object shapes", "shapeObjects")
    part("mask files", "motorcade::ObjectViewWriter::write(", frames)
    part("last estimates", "motorcade::StageRunner::finish()", 1)
  }
}

# A function's name stands where it is met first, and its number alone after that. After "calls=" the next line has the callee's share.
/^c?fn=\(/ {
  number = $0; sub(/^c?fn=/, "", number)
  name = number; sub(/^\([0-9]+\) ?/, "", name)
  sub(/\).*/, ")", number)
  if (name != "") for (i = 1; i <= count; ++i) if (index(name, prefix_of[order[i]]) == 1) part_of[number] = order[i]
  if ($0 ~ /^cfn/) callee = number
  next
}
/^calls=/ { calls_here = substr($1, 7); in_callee = 1; next }
/^[0-9+*-]/ {
  if (!in_callee) { own += $2; next }
  in_callee = 0
  if (callee in part_of) { calls[part_of[callee]] += calls_here; inclusive[part_of[callee]] += $2 }
}
/^(totals|summary):/ { total = $2 }

END {
  if (!total || own != total) complain("the profile is not whole: its functions took " own + 0 " instructions, all " total + 0)
  rest = total
  for (i = 1; i <= count; ++i) {
    name = order[i]
    if (calls[name] != expected[name])
      complain(name ": " prefix_of[name] " was called " calls[name] + 0 " times, not " expected[name] ": perf/instructions/attribute.awk names the functions")
    line(name, inclusive[name])
    rest -= inclusive[name]
  }
  if (rest < 0) complain("the stages took more instructions than there are: one is within another")
  if (parts != "libpng") { line("rest", rest); line("all", total) }
  exit failed
}
