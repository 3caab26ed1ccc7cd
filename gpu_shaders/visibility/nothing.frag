// Nothing is seen here.

out uvec2 seen;

void main() {
    seen = uvec2(0u);
}
