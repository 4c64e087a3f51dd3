import { Alert, Stack, Text } from "@mantine/core";
import type { StaleStructure } from "../../api/types";
import { dateTime } from "../../lib/text/format";
import { differences, merged, type Structure } from "../../lib/structure";
import { ConflictResolutions } from "./ConflictResolutions";
import { StructureDifference } from "../structures/StructureDifference";

interface Props {
  stale: StaleStructure;
  mine: Structure;
  surfaces: readonly string[];
  /** Continues with this structure on top of the newest version. */
  onResolve: (structure: Structure) => void;
}

/** Conflict of two edits: both changes side by side, and three resolutions. */
export function StructureConflict({ stale, mine, surfaces, onResolve }: Props) {
  const { base, current } = stale;
  const theirs = differences(base.structure, current.structure, surfaces);
  const own = differences(base.structure, mine, surfaces);
  const both = merged(base.structure, current.structure, mine, surfaces);
  return (
    <Alert color="yellow" variant="light" title="Changed by another analyst" data-testid="conflict">
      <Text size="sm" mb="sm">
        You edited version {base.version}; {current.author || "somebody"} saved version{" "}
        {current.version} at {dateTime(current.created_at)}
        {current.note !== "" && <> (“{current.note}”)</>}. Your changes are preserved. Select a
        resolution, check the result, and save.
      </Text>
      <div className="halves">
        <Stack gap={4}>
          <Text size="sm" fw={600}>
            Theirs
          </Text>
          <StructureDifference
            found={theirs}
            before={`Version ${base.version}`}
            after={`Version ${current.version}`}
          />
        </Stack>
        <Stack gap={4}>
          <Text size="sm" fw={600}>
            Yours
          </Text>
          <StructureDifference found={own} before={`Version ${base.version}`} after="Yours" />
        </Stack>
      </div>
      <ConflictResolutions
        merged={both.structure}
        mine={mine}
        theirs={current.structure}
        clashes={both.clashes}
        onResolve={onResolve}
      />
    </Alert>
  );
}
