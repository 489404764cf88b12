# A cut of the paper's algorithm
# The paper's figure of a minimisation step, drawn anew by the algorithm itself.
folder=$(mktemp -d)
cargo run --release --quiet -p colltrans-lab -- pictures -o "$folder"
cp "$folder/figure-09.svg" "$1"
