import { Text } from "@mantine/core";
import { Link } from "@tanstack/react-router";
import type { ReviewedGlobalModel } from "../../api/types";

/** States that no runs are selected, and which approved global model is used. */
export function ApprovedModelNote({ version }: { version: ReviewedGlobalModel | undefined }) {
  if (version === undefined) return null;
  return (
    <Text size="sm" data-testid="approved-model">
      No runs are selected: runs of the approved{" "}
      <Link to="/global-model/$id" params={{ id: version.id }} className="link">
        global model version {version.version}, {version.label}
      </Link>
      .
    </Text>
  );
}
