# A row of perf/accuracy.sh's tables. The input is a list of evaluations of one drive, one for each seed; figures are means over them.
def fixed(n): if . == null then "-" else . * pow(10; n) | round / pow(10; n) end;
def percent(n): if . == null then "-" else "\(100 * . | fixed(n)) %" end;
def mean(value): [.[] | value | numbers] | if length == 0 then null else add / length end;
def sum(value): [.[] | value | numbers] | add;
# Of a statistic of the final estimates, and of the online ones; one over nothing has no value.
def counted(key): if (.count // 0) == 0 then null else .[key] end;
def both(statistic; key; n):
  "\(mean(.final | statistic | counted(key)) | fixed(n)) / \(mean(.online | statistic | counted(key)) | fixed(n))";
def share(counts):
  if (sum(counts | .labels) // 0) == 0 then "-"
  else "\(sum(counts | .found) / sum(counts | .labels) | percent(0)) (\(sum(counts | .found))/\(sum(counts | .labels)))" end;
def largest(axis): [.[].final.objects_mean.largest_origin_drift_m[axis]] | max;

def camera_row:
  def of(key): mean(.final.camera | key);
  def mounted(key): mean(.final.camera_mounted | key);
  [mean(.frames) | fixed(0)] +
  [of(.ate_m.rmse) | fixed(3)] +
  ["\(of(.end_error_percent) | fixed(2)) %"] +
  ["\(of(.rpe_t_m.rmse) | fixed(4)) / \(of(.rpe_t_m.median) | fixed(4))"] +
  ["\(of(.rpe_r_deg.rmse) | fixed(4)) / \(of(.rpe_r_deg.median) | fixed(4))"] +
  [if mounted(.ate_m.rmse) == null then "-" else
    "\(mounted(.ate_m.rmse) | fixed(3)), \(mounted(.end_error_percent) | fixed(2)) %, \(mounted(.rpe_t_m.rmse) | fixed(4))" end];

def objects_row:
  [both(.motion.me_t_m; "mean"; 4), both(.motion.me_r_deg; "mean"; 3), both(.motion.speed_error_mps; "mean"; 2),
   share(.final.detection.within_30m), share(.final.detection.from_30_to_50m),
   "\(sum(.final.detection.false_rows)) of \(sum(.final.detection.rows))", sum(.final.detection.id_switches)];

def positions_row:
  def ate(kind): mean(.final.objects_mean | select(.objects > 0) | .ate_rmse_m[kind]) | fixed(3);
  def re(kind): mean(.baseline.objects | values | select(.objects_of_mean > 0) | .mean_relative_error[kind]) | percent(1);
  [sum(.final.objects_mean.objects), ate("aligned"), ate("world_offset_removed"), ate("as_seen_offset_removed"),
   (mean(.final.objects_mean | select(.objects > 0) | .are_rmse_deg) | fixed(2)),
   re("aligned"), re("world_offset_removed"), re("as_seen_offset_removed"),
   "\(largest(0) | fixed(2)) / \(largest(1) | fixed(2)) / \(largest(2) | fixed(2))"];

def boxes_row:
  def of(value): mean(.final.boxes_within_30m | select(.rows > 0) | value);
  def online(value): mean(.online.boxes_within_30m | select(.rows > 0) | value);
  def error(key; n): of(select(.rows_with_cuboid > 0) | .[key].mean) | fixed(n);
  ["\(of(.iou_2d) | fixed(2)) / \(online(.iou_2d) | fixed(2))", (of(.over_half_2d) | percent(0)),
   "\(of(.iou_bird) | fixed(2)) / \(online(.iou_bird) | fixed(2))", (of(.iou_3d) | fixed(2)),
   error("center_m"; 2), error("heading_deg"; 1), error("length_m"; 2), error("width_m"; 2), error("height_m"; 2)];

# Within 30 m, unless said otherwise.
def tracking_row:
  def hota(range; key): mean(.final.hota | range | select(.labels > 0) | .[key]) | fixed(2);
  def online(range): mean(.online.hota | range | select(.labels > 0) | .hota) | fixed(2);
  def image: .image.within_30m;
  def above: .footprint.within_30m;
  def masks(range; value): mean(.masks | values | range | select(.rows > 0) | value) | fixed(2);
  def kinds(estimate): mean(estimate | .kinds_within_30m.from_tenth_row | select(.rows > 0) | .right) | percent(0);
  def waited(range): .online.first_report | range;
  def frames(range; key): mean(waited(range) | .frames | counted(key)) | fixed(1);
  def reports(range): "\(frames(range; "median")) / \(frames(range; "mean"))" +
    (sum(waited(range) | .never) | if . > 0 then ", \(.) never" else "" end);
  ["\(hota(image; "hota")) / \(online(image))", hota(image; "det_a"), hota(image; "ass_a"), hota(image; "loc_a"),
   hota(.image.within_50m; "hota"), "\(hota(above; "hota")) / \(online(above))",
   masks(.within_30m; .iou), masks(.from_30_to_50m; .iou), (mean(.masks | values | .within_30m.boundary_px | counted("mean")) | fixed(1)),
   "\(kinds(.final)) / \(kinds(.online))",
   reports(.within_30m), reports(.within_50m)];

# Without the truth's mounting error where it may have one.
def covariances_row:
  def camera: .covariance | .camera_mounted // .camera | select(.samples > 0);
  def rotation: .covariance | .camera_mounted_with_truth_noise // .camera | select(.samples > 0) | .rotation;
  def objects: .covariance.objects | select(.samples > 0);
  [(mean(camera | .mean_nees) | fixed(2)), (mean(camera | .coverage_95) | percent(1)), (mean(rotation | .coverage_95) | percent(1)),
   (mean(objects | .mean_nees) | fixed(2)), (mean(objects | .coverage_95) | percent(1))];

(if $table == "camera" then camera_row
 elif .[0].final.detection == null and $table != "covariances" then ["no labels"]
 elif $table == "objects" then objects_row
 elif $table == "positions" then positions_row
 elif $table == "boxes" then boxes_row
 elif $table == "tracking" then tracking_row
 else covariances_row end) as $row |
"| \(([$name, $backend] + $row) | map(tostring) | join(" | ")) |"
