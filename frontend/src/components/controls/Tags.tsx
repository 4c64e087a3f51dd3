import { Badge } from "@mantine/core";

/** Words that analysts put on a maneuver or run. */
export function Tags({ tags }: { tags: readonly string[] }) {
  return tags.map((tag) => (
    <Badge key={tag} variant="outline" color="gray" c="var(--mantine-color-text)" tt="none" mr={4}>
      {tag}
    </Badge>
  ));
}
