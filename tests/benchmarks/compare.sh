#!/usr/bin/env bash
# Measures whole commands beside OpenCV's and COLMAP's programs and FFmpeg's decoding, and velamap beside
# itself with more work. Each part writes a table PART.csv into the work folder and prints it.
# usage: tests/benchmarks/compare.sh [PART...] [WORK_FOLDER]   (default: all parts, workspace/compare)
#   detection   import of a clip; VideoCapture and detectMarkers(SUBPIX) in one loop; decoding alone
#   adjustment  registration and adjustment; colmap bundle_adjuster on a seed in time order
#   main        automatic_reconstructor around a named central frame; decoding of those frames
#   memory      peak memory of the import of a short and a long clip
#   growth      import with twice the frames, and with larger ones; always at 1280 px, too
#   markers     detection in one frame with 20 to 500 markers
#   tracking    import with exhaustive search, with tracked search, and with a prior shape: what each of
#               them finds, and the time of the search
#   sweep       central_frame_sweeper; as many single runs
#   dataset     the two jobs of a clip of workflows/dataset, on one thread: time, memory, sizes of files
# Times are CPU seconds, user and system, of all threads and children, because other programs on the
# machine change wall times more. Decoding is measured before and after what it is compared with. Clips
# are rendered with a usual action camera and fixed seeds, and kept in WORK_FOLDER/clips.
# BUILD: folder of the build (build/release). WIDTHS, NUM_FRAMES, MBIT, LONG, REPEATS,
# CENTRAL_FRAMES: sizes.
set -euo pipefail
export LC_ALL=C

fail() {
  echo "error: $*" >&2
  exit 2
}

repository="$(realpath "$(dirname "${BASH_SOURCE[0]}")/../..")"
build="${BUILD:-$repository/build/release}"
work="workspace/compare"
parts=()
for argument in "$@"; do
  case "$argument" in
    detection | adjustment | main | memory | growth | markers | tracking | sweep | dataset) parts+=("$argument") ;;
    --help)
      sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"
      exit 0
      ;;
    -*) fail "$argument: unknown option; see --help" ;;
    *) work="$argument" ;;
  esac
done
if [[ ${#parts[@]} -eq 0 ]]; then parts=(detection adjustment main memory growth markers tracking sweep dataset); fi
read -ra widths <<<"${WIDTHS:-1920 3840}"
num_frames="${NUM_FRAMES:-200}"
mbit="${MBIT:-100}"
long="${LONG:-2000}"
repeats="${REPEATS:-3}"
central_frames="${CENTRAL_FRAMES:-11}"
for size in "${widths[@]}" "$num_frames" "$mbit" "$long" "$repeats" "$central_frames"; do
  [[ "$size" =~ ^[1-9][0-9]*$ ]] ||
    fail "$size is no size; WIDTHS, NUM_FRAMES, MBIT, LONG, REPEATS, CENTRAL_FRAMES take integers from 1"
done

velamap="$build/workflows/velamap"
render_clip="$build/tests/tools/render_clip"
plain_detection="$build/tests/benchmarks/plain_detection"
compare_detections="$build/tests/benchmarks/compare_detections"
velamap_benchmark="$build/tests/benchmarks/velamap_benchmark"
for program in "$velamap" "$render_clip" "$plain_detection" "$compare_detections" \
  "$velamap_benchmark"; do
  [[ -x "$program" ]] || fail "$program is not built; cmake --build it, or set BUILD to the build's folder"
done
[[ -x /usr/bin/time ]] || fail "/usr/bin/time is missing (Debian package time)"
mkdir -p "$work/clips"
work="$(realpath "$work")"

# clip KIND WIDTH: prints the folder of a rendered clip, calm or busy. It is compressed as an action
# camera does it: 4K to MBIT Mbit/s, other sizes to as many bits per pixel.
clip() {
  local bitrate="$((mbit * 1000 * $2 / 3840 * $2 / 3840))k" busy=0
  local folder="$work/clips/action_$1_$2_${num_frames}_$bitrate"
  if [[ $1 == busy ]]; then busy=1; fi
  if [[ ! -f "$folder/whole" ]]; then
    "$render_clip" --camera action --output_path "$folder" --width "$2" --num_frames "$num_frames" --busy "$busy" \
      --bitrate "$bitrate" --seed 1 >"$work/render.log" 2>&1 || fail "render_clip: $(tail -n 1 "$work/render.log")"
    touch "$folder/whole"
  fi
  echo "$folder"
}

# looped FOLDER FRAMES: prints the folder of the clip repeated to that many frames, not encoded again.
looped() {
  local folder="$1_looped_$2"
  mkdir -p "$folder"
  cp "$1/camera.yml" "$1/layout.yml" "$folder/"
  if [[ ! -f "$folder/clip.mp4" ]]; then
    ffmpeg -v error -y -stream_loop -1 -i "$1/clip.mp4" -c copy -frames:v "$2" "$folder/part.mp4"
    mv "$folder/part.mp4" "$folder/clip.mp4"
  fi
  echo "$folder"
}

# measure COMMAND...: runs the command and sets cpu (s) and memory (MB). Its stdout goes to out.txt.
measure() {
  /usr/bin/time -o "$work/time.txt" -f '%U %S %M' "$@" >"$work/out.txt" 2>"$work/err.txt" ||
    fail "$*: $(tail -n 1 "$work/err.txt")"
  read -r cpu memory < <(awk '{ printf "%.2f %.0f\n", $1 + $2, $3 / 1024 }' "$work/time.txt")
}

# value KEY: prints the value of `KEY: value` in the last command's stdout.
value() { awk -F': ' -v key="$1" '$1 == key { print $2 }' "$work/out.txt"; }

megabytes() { du -sb "$1" | awk '{ printf "%.1f", $1 / 1e6 }'; }

mean() { awk -v a="$1" -v b="$2" 'BEGIN { printf "%.2f", (a + b) / 2 }'; }

percent() { awk -v a="$1" -v b="$2" 'BEGIN { printf "%.2f", (b > 0 ? 100 * a / b : 0) }'; }

# run_on_clip COMMAND FOLDER [OPTION...]: measures one of velamap's commands on a clip.
run_on_clip() {
  local command="$1" folder="$2"
  shift 2
  measure "$velamap" "$command" --image_path "$folder/clip.mp4" \
    --camera_path "$folder/camera.yml" --layout_path "$folder/layout.yml" "$@"
}

# import FOLDER [OPTION...]: measures the import of a clip into database.db.
import() {
  rm -f "$work/database.db"
  run_on_clip marker_importer "$@" --database_path "$work/database.db"
}

# reconstruct FOLDER [OPTION...]: measures a whole reconstruction of a clip, into result/.
reconstruct() {
  rm -rf "$work/result"
  run_on_clip automatic_reconstructor "$@" --workspace_path "$work/result"
}

# search_ms FRAMES: prints the CPU time per frame of the search in the last import, ms.
search_ms() {
  awk -v frames="$1" '/ detect / { for (i = 1; i < NF; i++) if ($i == "detect") seconds = $(i + 2) }
    END { printf "%.0f", 1000 * seconds / frames }' "$work/err.txt"
}

decode() { measure ffmpeg -v error -i "$1/clip.mp4" -an -f null -; }

compare_detection() {
  local width kind folder repeat decoding_cpu import_cpu import_markers
  echo "kind,width_px,num_frames,velamap_cpu_s,velamap_markers,opencv_cpu_s,opencv_markers,decoding_cpu_s"
  for width in "${widths[@]}"; do
    for kind in calm busy; do
      folder="$(clip "$kind" "$width")"
      for ((repeat = 0; repeat < repeats; repeat++)); do
        decode "$folder"
        decoding_cpu="$cpu"
        import "$folder"
        import_cpu="$cpu" import_markers="$(value markers)"
        decode "$folder"
        decoding_cpu="$(mean "$decoding_cpu" "$cpu")"
        measure "$plain_detection" "$folder/clip.mp4" \
          "$(sed -n 's/^dictionary: *//p' "$folder/layout.yml")"
        echo "$kind,$width,$num_frames,$import_cpu,$import_markers,$cpu,$(value markers),$decoding_cpu"
      done
    done
  done
}

compare_adjustment() {
  local repeat
  echo "num_frames,num_markers,velamap_cpu_s,colmap_cpu_s"
  for ((repeat = 0; repeat < repeats; repeat++)); do
    "$velamap_benchmark" --benchmark_format=csv \
      --benchmark_filter='InTimeOrder/41/10/13|RegistrationAndAdjustment' 2>/dev/null |
      awk -F, '
        /^name/ { gsub(/"/, ""); for (i = 1; i <= NF; i++) column[$i] = i; next }
        /^"?BM_/ {
          gsub(/"/, "", $1)
          split($1, part, "/")
          size = part[2] "," part[3] * part[4]
          if ($1 ~ /InTimeOrder/) colmap[size] = $column["cpu_s"]
          else { ours[size] = $column["cpu_s"]; order[++n] = size }
        }
        END {
          for (i = 1; i <= n; i++) {
            s = order[i]
            printf "%s,%.2f,%s\n", s, ours[s], s in colmap ? sprintf("%.2f", colmap[s]) : ""
          }
        }'
  done
}

compare_main() {
  local width repeat folder decoding_cpu main_cpu
  echo "width_px,num_frames,automatic_reconstructor_cpu_s,decoding_cpu_s,\
import_cpu_s,register_cpu_s,adjust_cpu_s,export_cpu_s,report_cpu_s"
  for width in "${widths[@]}"; do
    folder="$(clip calm "$width")"
    for ((repeat = 0; repeat < repeats; repeat++)); do
      decode "$folder"
      decoding_cpu="$cpu"
      reconstruct "$folder" --Registration.method thesis --central_frame $((num_frames / 2)) \
        --backend markers
      main_cpu="$cpu"
      decode "$folder"
      decoding_cpu="$(mean "$decoding_cpu" "$cpu")"
      awk -v row="$width,$num_frames,$main_cpu,$decoding_cpu" '
        /"stage"/ { gsub(/[",]/, ""); stage = $2 }
        /"cpu_s"/ && stage ~ /^(import|register|adjust|export|report)$/ {
          sub(/,/, "", $2); row = row sprintf(",%.2f", $2) }
        END { print row }' "$work/result/timing.json"
    done
  done
}

compare_memory() {
  local width folder frames
  echo "width_px,num_frames,peak_memory_mb,cpu_s"
  for width in "${widths[@]}"; do
    for frames in 100 "$long"; do
      folder="$(looped "$(clip calm "$width")" "$frames")"
      import "$folder"
      echo "$width,$frames,$memory,$cpu"
    done
  done
}

compare_growth() {
  local width folder repeat once
  echo "width_px,num_frames,cpu_s,cpu_s_of_twice_the_frames"
  for width in 1280 "${widths[@]}"; do
    folder="$(clip calm "$width")"
    for ((repeat = 0; repeat < repeats; repeat++)); do
      import "$folder"
      once="$cpu"
      import "$(looped "$folder" $((2 * num_frames)))"
      echo "$width,$num_frames,$once,$cpu"
    done
  done
}

compare_markers() {
  echo "num_markers,detection_ms"
  "$velamap_benchmark" --benchmark_format=csv --benchmark_filter=DetectManyMarkers 2>/dev/null |
    awk -F, '
      /^name/ { gsub(/"/, ""); for (i = 1; i <= NF; i++) column[$i] = i; next }
      /^"?BM_/ {
        gsub(/"/, "", $1)
        split($1, part, "/")
        printf "%d,%.0f\n", part[2] * part[3], $column["cpu_time"] | "sort -t, -k1n"
      }'
}

compare_tracking() {
  local width kind folder search ms row
  echo "kind,width_px,num_frames,search,markers,found_again_percent,same_corners_percent,search_ms"
  for width in "${widths[@]}"; do
    for kind in calm busy; do
      folder="$(clip "$kind" "$width")"
      row="$kind,$width,$num_frames"
      import "$folder" --ArucoDetection.search exhaustive
      echo "$row,exhaustive,$(value markers),,,$(search_ms "$num_frames")"
      mv "$work/database.db" "$work/exhaustive.db"
      reconstruct "$folder"
      for search in tracked prior_shape; do
        if [[ $search == tracked ]]; then import "$folder"; else
          import "$folder" --prior_shape_path "$work/result/shape"
        fi
        ms="$(search_ms "$num_frames")"
        measure "$compare_detections" "$work/exhaustive.db" "$work/database.db"
        echo "$row,$search,$(value other),$(percent "$(value found_again)" "$(value reference)"),$(
          percent "$(value same_corners)" "$(value found_again)"),$ms"
      done
    done
  done
}

compare_sweep() {
  local folder first frames=() frame layout cold repeat sum sweep
  folder="$(clip calm "${widths[0]}")"
  import "$folder"
  first=$((num_frames / 2 - central_frames / 2))
  for ((frame = first; frame < first + central_frames; frame++)); do frames+=("$frame"); done
  layout=(--layout_path "$folder/layout.yml" --log_level error)
  echo "width_px,num_frames,num_central_frames,single_runs_cpu_s,sweep_with_cold_starts_cpu_s,sweep_cpu_s"
  for ((repeat = 0; repeat < repeats; repeat++)); do
    sum=0
    for frame in "${frames[@]}"; do
      measure "$velamap" frame_registrator --database_path "$work/database.db" "${layout[@]}" \
        --output_path "$work/seed" --Registration.method thesis --central_frame "$frame"
      sum="$(awk -v a="$sum" -v b="$cpu" 'BEGIN { print a + b }')"
      measure "$velamap" bundle_adjuster --backend markers --database_path "$work/database.db" \
        "${layout[@]}" --input_path "$work/seed" --output_path "$work/adjusted"
      sum="$(awk -v a="$sum" -v b="$cpu" 'BEGIN { print a + b }')"
    done
    sweep=("$velamap" central_frame_sweeper --database_path "$work/database.db" "${layout[@]}"
      --output_path "$work/sweep_result.csv" --central_frames "$(IFS=,; echo "${frames[*]}")")
    measure "${sweep[@]}" --warm_start 0
    cold="$cpu"
    measure "${sweep[@]}"
    echo "${widths[0]},$num_frames,$central_frames,$sum,$cold,$cpu"
  done
}

compare_dataset() {
  local width folder import_cpu import_memory
  echo "width_px,num_frames,clip_mb,workspace_mb,import_cpu_s,import_memory_mb,reconstruct_cpu_s,\
reconstruct_memory_mb"
  for width in "${widths[@]}"; do
    folder="$(clip calm "$width")"
    rm -rf "$work/result"
    mkdir "$work/result"
    run_on_clip marker_importer "$folder" --database_path "$work/result/database.db" --num_threads 1
    import_cpu="$cpu" import_memory="$memory"
    run_on_clip automatic_reconstructor "$folder" --workspace_path "$work/result" --num_threads 1
    echo "$width,$num_frames,$(megabytes "$folder/clip.mp4"),$(megabytes "$work/result"),\
$import_cpu,$import_memory,$cpu,$memory"
  done
}

# A table that breaks off leaves that of an earlier run in place.
for part in "${parts[@]}"; do
  "compare_$part" >"$work/$part.part"
  mv "$work/$part.part" "$work/$part.csv"
  echo "$work/$part.csv"
  column -s, -t "$work/$part.csv"
done
