# Map of all directions
# Clearance of a dodecahedron next to a bracket in all directions: orange is free, with its proven border; blue is
# blocked, paler for later contacts.
folder=$(mktemp -d)
cp data/dodecahedron.off data/bracket.obj "$folder"
cat >"$folder/two.toml" <<'END'
[[part]]
file = "dodecahedron.off"
name = "dodecahedron"
translation = [6, 3, 5]

[[part]]
file = "bracket.obj"
name = "bracket"
END
colltrans assembly "$folder/two.toml" --map dodecahedron -o "$folder/out" >"$folder/told"
cp "$folder/out/map-dodecahedron.svg" "$1"
