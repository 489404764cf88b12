# A cut of the paper's algorithm
# The paper's figure of a minimisation step, computed by the algorithm.
folder=$(mktemp -d)
cargo run --release --quiet -p colltrans-lab -- pictures -o "$folder"
cp "$folder/figure-09.svg" "$1"
