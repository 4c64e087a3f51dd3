"""The permission of every route, in one table.

Routes are named by the function that responds. A route without a permission is refused in every
mode but the personal one, and by a test. The reference page of permissions and the test of all
routes are made from this table.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from typing import Any

from flexsid.figure_table import FIGURES
from flexsid.jobs.kinds import ANALYSES
from flexsid.records.account import AccountRole


class Permission(StrEnum):
    """Who may use a route: everybody, every account, or a role in the campaign of the records."""

    PUBLIC = "public"
    ACCOUNT = "account"
    VIEWER = "viewer"
    ANALYST = "analyst"
    REVIEWER = "reviewer"
    ADMIN = "admin"

    @property
    def role(self) -> AccountRole | None:
        """The role that is needed; None if the route concerns no campaign."""
        return None if self in (Permission.PUBLIC, Permission.ACCOUNT) else AccountRole(self.value)


_ROUTES: dict[Permission, tuple[str, ...]] = {
    Permission.PUBLIC: (
        *("check_liveness", "check_readiness"),
        *("get_session", "log_in", "log_out", "accept_invitation", "list_axes"),
        *("begin_openid_login", "complete_openid_login"),
    ),
    Permission.ACCOUNT: (
        *("get_health", "get_metrics", "list_nomenclature", "list_units", "list_job_kinds"),
        *("list_catalogue", "set_display_units"),
        *("list_tokens", "create_token", "delete_token"),
        *("change_password", "list_sessions", "end_all_sessions", "end_other_session"),
    ),
    Permission.VIEWER: (
        *("list_aircraft", "get_aircraft", "list_flights", "get_flight", "list_flight_channels"),
        *("get_dashboard", "list_repeated_levels"),
        *("find_maneuvers", "list_ground_tests", "get_ground_test"),
        *("list_maneuvers", "list_maneuver_facets", "get_maneuver", "get_run_proposal"),
        "get_samples",
        *("get_quality", "list_conditioning", "list_qualities", "list_mappings", "get_mapping"),
        *("list_modal_tables", "get_model_order", "get_modal_table", "list_modes", "get_shape"),
        *("get_correlation", "get_observability", "download_modes", "download_archive"),
        *("draw_picture", "list_flutter_summaries"),
        *("get_flutter_summary", "get_summary_roots"),
        *("list_measured_responses", "get_measured_responses", "get_response_function"),
        *("get_orthogonality", "get_identified_modes"),
        *("list_grey_box_models", "list_grey_box_fits", "get_grey_box_fit"),
        *("list_predictions", "get_prediction", "list_model_structures"),
        *("get_model_structure", "list_structure_versions", "get_structure_version"),
        *("list_decisions", "get_campaign_audit", "get_decision", "get_decision_audit"),
        *("get_vote_evidence", "get_proposal_evidence", "list_notes", "get_note"),
        *("list_run_templates", "get_run_template"),
        *("get_review_rules", "list_campaign_baselines", "list_maneuver_baselines"),
        *("get_frozen_figure", "get_notifications", "mark_notifications_seen"),
        *("mark_decision_seen", "mark_structure_seen", "list_runs", "list_run_facets", "get_run"),
        *("get_run_export", "get_run_model", "get_run_capsule", "get_run_fmu"),
        "get_run_jsbsim",
        *("list_saved_views", "list_searches", "get_search"),
        *("list_jobs", "get_queue_status", "get_job", "get_job_log", "stream_events"),
        *("list_batches", "get_batch", "get_comparison", "get_trend", "report_run"),
        *("list_conditions", "get_condition_sheet", "get_condition_notebook"),
        *("get_condition_derivatives", "get_run_notebook"),
        *("report_comparison", "report_decision", "report_campaign", "list_designs", "get_design"),
        *("report_run_card", "report_global_model", "report_flutter", "report_closed_loop"),
        *("report_sortie", "print_run", "print_comparison", "print_decision", "print_campaign"),
        *("print_run_card", "print_global_model", "print_flutter", "print_closed_loop"),
        *("print_sortie", "report_figure", "print_figure", "get_printed_report"),
        *(
            "check_design",
            "get_target_modes",
            "list_catalogue_targets",
            "get_expected_errors",
        ),
        "get_expected_response",
        "list_preflight_simulations",
        *("export_design", "list_controllers", "get_controller"),
        "get_closed_loop",
        *("list_receivers", "list_streams", "get_stream", "get_stream_samples"),
        *("get_stream_history", "draw_live_bode"),
        "get_global_model_dave_ml",
        *("list_write_backs", "propose_write_back"),
        *("list_global_model_versions", "get_global_model_version", "compare_global_models"),
        "get_global_model_fmu",
        *(f"draw_{name.replace('-', '_')}" for name in FIGURES),
        *(name for one in ANALYSES for name in one.reading_routes),
    ),
    Permission.ANALYST: (
        *("replace_aircraft", "set_thrust", "remove_thrust"),
        *("cut_maneuver", "upload_maneuver", "change_maneuvers"),
        *(
            "delete_maneuver",
            "add_conditioning",
            "undo_conditioning",
            "correct_cause",
            "assess_maneuvers",
        ),
        *("stop_assessment", "add_mapping", "delete_mapping", "upload_files"),
        *(
            "get_upload",
            "delete_upload",
            "get_import_job",
            "check_upload",
            "preview_upload",
            "list_uploads",
        ),
        *("import_upload", "delete_modal_table", "correct_mode", "inspect_modal_files"),
        *("import_modal_data", "import_flutter_summary", "import_responses"),
        "estimate_responses",
        "import_mass_properties",
        *("save_identified_modes", "request_orthogonality", "add_model_structure"),
        "request_grey_box_fit",
        *("edit_model_structure", "propose_decision", "revise_decision", "comment_decision"),
        *("withdraw_decision", "freeze_figure", "request_run", "change_runs", "delete_run"),
        *("add_saved_view", "delete_saved_view", "request_search", "cancel_search"),
        *("create_candidate_run", "cancel_job", "retry_job", "request_batch", "cancel_batch"),
        *("retry_batch", "create_design", "start_design", "import_multisines", "delete_design"),
        *("rescale_design", "redesign_phases", "simulate_design", "create_controller"),
        *("upload_controller", "delete_controller"),
        "compute_prediction",
        "save_updated_table",
        *("save_global_prediction", "add_global_model_version"),
        *("add_write_back", "undo_write_back"),
        *("start_stream", "stop_stream", "delete_stream", "push_frames", "acknowledge_alarm"),
        "decide_test_point",
        "save_upload_draft",
        *("add_note", "edit_note", "delete_note"),
        *("add_run_template", "edit_run_template", "delete_run_template"),
        *(f"request_{one.noun}" for one in ANALYSES),
    ),
    Permission.REVIEWER: ("vote_on_decision",),
    Permission.ADMIN: (
        *("add_aircraft", "change_review_rules", "list_audit_events"),
        *("request_backup", "get_backup"),
    ),
}

PERMISSIONS: dict[str, Permission] = {
    name: permission for permission, names in _ROUTES.items() for name in names
}
"""Permission by the name of the route."""


def find_refusal(
    permission: Permission, role: AccountRole | None, *, is_own: bool = True
) -> int | None:
    """Return the HTTP status by which a route refuses an account; None if it responds.

    Parameters
    ----------
    permission
        Permission of the route.
    role
        Role of the account in its campaigns.
    is_own
        Whether the records that the request names are in a campaign of the account.
    """
    needed = permission.role
    if needed is None:
        return None
    if not is_own:
        return 404
    if role is None:
        return None if needed is AccountRole.VIEWER else 403
    return None if role.rank >= needed.rank else 403


def write_permissions(paths: Mapping[str, Mapping[str, Any]]) -> str:
    """Return the table of all routes as Markdown, from the paths of the OpenAPI description."""
    columns = ("nobody", *AccountRole, "member of other campaigns")
    lines = [
        "# Permissions",
        "",
        "What each route responds in team and organisation mode: ✓, or the HTTP status by which it",
        "refuses. Roles are those in the campaign of the records that the request names; a request",
        "that names none concerns the campaigns in which the account has the role, and lists",
        "have only records of these. Records of other campaigns do not exist for an account: 404,",
        "as for ids that were never given. In personal mode every route responds.",
        "",
        f"| route | needs | {' | '.join(columns)} |",
        f"| --- | --- |{' --- |' * len(columns)}",
    ]
    for path, methods in paths.items():
        for method, operation in methods.items():
            permission = PERMISSIONS[operation["operationId"]]
            found = [
                None if permission is Permission.PUBLIC else 401,
                *(find_refusal(permission, role) for role in AccountRole),
                find_refusal(permission, None, is_own=False),
            ]
            cells = " | ".join("✓" if status is None else str(status) for status in found)
            lines.append(f"| `{method.upper()} {path}` | {permission.value} | {cells} |")
    return "\n".join(lines) + "\n"
