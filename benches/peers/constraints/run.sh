# Part of ../run that compares mechanisms with constraints; ../run defines all variables that are used here.
# shellcheck shell=bash disable=SC2154

here=$sources/constraints
into=$out/constraints
mkdir -p "$into"

compile "$into/libpinocchio.so" "$here/pinocchio.cpp" -O3 -march=native -shared -fPIC
mujoco=$site/mujoco
cc -O3 -march=native -shared -fPIC "-I$mujoco/include" "$here/mujoco.c" -o "$into/libmujoco.so" \
    "$mujoco"/libmujoco.so.* "-Wl,-rpath,$mujoco"

# Runs the program, with one build per target: constraints [default | native] ARGUMENTS...
constraints() {
    local rust="" build=$1 && shift
    [ "$build" = native ] && rust="-C target-cpu=native"
    RUSTFLAGS=$rust cargo run --quiet --release --locked -p linkwork-benches --bin constraints \
        --target-dir "$out/$build" -- "$@"
}

"$python" "$here/write.py" "$into"
for name in $(constraints "${builds[0]}" write "$into"); do
    folder=$into/$name
    if [ ! "$folder/sympy.fast.so" -nt "$here/derive.py" ]; then
        timeout 300 "$python" "$here/derive.py" "$name" "$folder" || continue
        for way in "exact" "fast -ffast-math"; do
            read -r kind flag <<<"$way"
            # shellcheck disable=SC2086
            cc -O3 -march=native $flag -shared -fPIC "$folder/sympy.c" -o "$folder/sympy.$kind.so" -lm
        done
    fi
    rm -f "$folder/python"
    timeout 300 "$python" "$here/derive.py" --python "$name" "$folder" >&2 || echo "constraints: no Python for $name" >&2
done

echo "$(date +%F), $(grep -m1 'model name' /proc/cpuinfo | cut -d: -f2- | xargs), $(rustc --version | cut -d' ' -f1,2)"
"$python" -m pip list 2>/dev/null | awk '$1 ~ /^(pin|mujoco|sympy|pydy|scipy|numpy)$/ {print $1, $2}'
echo "Pinocchio by $("$cxx" --version | head -1); C of SymPy by $(cc --version | head -1)"
for build in "${builds[@]}"; do
    echo && echo "Linkwork for the $build target:" && echo
    constraints "$build" measure "$into" ${quick[@]+"${quick[@]}"}
done
