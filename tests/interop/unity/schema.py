"""What Unity documents of the classes and importers that a package has.

Class numbers: https://docs.unity3d.com/Manual/ClassIDReference.html. The fields are the serialised forms of the properties that the
scripting reference lists, https://docs.unity3d.com/2021.3/Documentation/ScriptReference/<class>.html; the class is named beside each
table where its page has another name.
"""

from documents import require

REFERENCE = "reference"
FLAG = "0 or 1"
INTEGER = "whole number"
NUMBER = "number"
TEXT = "text"
LIST = "list"


def vector(names):
    return {name: NUMBER for name in names}


BASE = {"m_ObjectHideFlags": INTEGER, "m_CorrespondingSourceObject": REFERENCE}
COMPONENT = {**BASE, "m_GameObject": REFERENCE}

# By the number of the class: its name, and its fields.
CLASSES = {
    1: (
        "GameObject",
        {
            **BASE,
            "m_Component": [{"component": REFERENCE}],
            "m_Layer": INTEGER,
            "m_Name": TEXT,
            "m_TagString": TEXT,
            "m_StaticEditorFlags": INTEGER,
            "m_IsActive": FLAG,
        },
    ),
    4: (
        "Transform",
        {
            **COMPONENT,
            "m_LocalRotation": vector("xyzw"),
            "m_LocalPosition": vector("xyz"),
            "m_LocalScale": vector("xyz"),
            "m_Children": [REFERENCE],
            "m_Father": REFERENCE,
        },
    ),
    21: (
        "Material",
        {
            **BASE,
            "m_Name": TEXT,
            "m_Shader": REFERENCE,
            "m_ValidKeywords": [TEXT],
            "m_InvalidKeywords": LIST,
            "m_CustomRenderQueue": INTEGER,
            "m_SavedProperties": {"m_TexEnvs": LIST, "m_Floats": LIST, "m_Colors": LIST},
        },
    ),
    23: (
        "MeshRenderer",
        {
            **COMPONENT,
            "m_Enabled": FLAG,
            "m_CastShadows": INTEGER,
            "m_ReceiveShadows": FLAG,
            "m_Materials": [REFERENCE],
        },
    ),
    33: ("MeshFilter", {**COMPONENT, "m_Mesh": REFERENCE}),
    54: (
        "Rigidbody",
        {
            **COMPONENT,
            "m_Mass": NUMBER,
            "m_Drag": NUMBER,
            "m_AngularDrag": NUMBER,
            "m_UseGravity": FLAG,
            "m_IsKinematic": FLAG,
            "m_Interpolate": INTEGER,
            "m_Constraints": INTEGER,
            "m_CollisionDetection": INTEGER,
        },
    ),
    64: (
        "MeshCollider",
        {
            **COMPONENT,
            "m_Material": REFERENCE,
            "m_IsTrigger": FLAG,
            "m_Enabled": FLAG,
            "m_Convex": FLAG,
            "m_CookingOptions": INTEGER,
            "m_Mesh": REFERENCE,
        },
    ),
    108: (
        "Light",
        {
            **COMPONENT,
            "m_Enabled": FLAG,
            "m_Type": INTEGER,
            "m_Color": vector("rgba"),
            "m_Intensity": NUMBER,
            "m_Range": NUMBER,
            "m_Shadows": {"m_Type": INTEGER},
        },
    ),
    134: (
        "PhysicMaterial",
        {
            **BASE,
            "m_Name": TEXT,
            "dynamicFriction": NUMBER,
            "staticFriction": NUMBER,
            "bounciness": NUMBER,
            "frictionCombine": INTEGER,
            "bounceCombine": INTEGER,
        },
    ),
    205: (
        "LODGroup",
        {
            **COMPONENT,
            "m_LocalReferencePoint": vector("xyz"),
            "m_Size": NUMBER,
            "m_FadeMode": INTEGER,
            "m_LODs": [
                {"screenRelativeHeight": NUMBER, "fadeTransitionWidth": NUMBER, "renderers": [{"renderer": REFERENCE}]}
            ],
            "m_Enabled": FLAG,
        },
    ),
}

# https://docs.unity3d.com/6000.3/Documentation/Manual/yaml-prefab-serialization.html
CLASSES[1001] = (
    "PrefabInstance",
    {
        "m_ObjectHideFlags": INTEGER,
        "m_Modification": {
            "m_TransformParent": REFERENCE,
            "m_Modifications": [
                {"target": REFERENCE, "propertyPath": TEXT, "value": None, "objectReference": REFERENCE}
            ],
            "m_RemovedComponents": LIST,
        },
        "m_SourcePrefab": REFERENCE,
    },
)
# Of an object of a nested prefab.
STRIPPED = {"m_CorrespondingSourceObject": REFERENCE, "m_PrefabInstance": REFERENCE, "m_PrefabAsset": REFERENCE}

IMPORTER = {"externalObjects": None, "userData": None, "assetBundleName": None, "assetBundleVariant": None}

# By importer: its fields. TextureImporter and ModelImporter are pages of the scripting reference, in UnityEditor.
IMPORTERS = {
    "DefaultImporter": IMPORTER,
    "TextScriptImporter": IMPORTER,
    "PackageManifestImporter": IMPORTER,
    "PrefabImporter": IMPORTER,
    "NativeFormatImporter": {**IMPORTER, "mainObjectFileID": INTEGER},
    "TextureImporter": {
        **IMPORTER,
        "serializedVersion": INTEGER,
        "mipmaps": {"enableMipMap": FLAG, "sRGBTexture": FLAG, "linearTexture": FLAG},
        "bumpmap": {"convertToNormalMap": FLAG, "flipGreenChannel": FLAG},
        "isReadable": FLAG,
        "maxTextureSize": INTEGER,
        "textureSettings": {"filterMode": INTEGER, "wrapU": INTEGER, "wrapV": INTEGER},
        "nPOTScale": INTEGER,
        "alphaUsage": INTEGER,
        "textureType": INTEGER,
        "textureShape": INTEGER,
        "platformSettings": [{"buildTarget": TEXT, "maxTextureSize": INTEGER, "textureCompression": INTEGER}],
    },
    "ModelImporter": {
        **IMPORTER,
        "serializedVersion": INTEGER,
        "internalIDToNameTable": [{"first": None, "second": TEXT}],
        "externalObjects": [{"first": {"type": TEXT, "assembly": TEXT, "name": TEXT}, "second": REFERENCE}],
        "materials": {"materialImportMode": INTEGER, "materialLocation": INTEGER},
        "animations": {"isReadable": FLAG},
        "meshes": {
            "globalScale": NUMBER,
            "meshCompression": INTEGER,
            "addColliders": FLAG,
            "importCameras": FLAG,
            "importLights": FLAG,
            "fileIdsGeneration": INTEGER,
            "swapUVChannels": FLAG,
            "generateSecondaryUV": FLAG,
            "useFileUnits": FLAG,
            "useFileScale": FLAG,
            "weldVertices": FLAG,
            "bakeAxisConversion": FLAG,
            "indexFormat": INTEGER,
        },
        "tangentSpace": {"normalImportMode": INTEGER, "tangentImportMode": INTEGER},
        "importAnimation": FLAG,
        "animationType": INTEGER,
    },
}

# Which importer takes a file, and the number of the object that it makes of it.
BY_ENDING = {
    "": ("DefaultImporter", None),
    ".md": ("TextScriptImporter", None),
    ".json": ("TextScriptImporter", None),
    ".prefab": ("PrefabImporter", None),
    ".mat": ("NativeFormatImporter", 2100000),
    ".physicMaterial": ("NativeFormatImporter", 13400000),
    ".png": ("TextureImporter", 2800000),
    ".jpg": ("TextureImporter", 2800000),
    ".fbx": ("ModelImporter", None),
}

# Shaders by GUID: what they are called, the kind of the reference, and for each role the slots and the keyword without which Unity
# ignores them. Standard: built into the editor, its number is 46. URP and HDRP: Lit.shader of the packages
# com.unity.render-pipelines.{universal,high-definition}.
SHADERS = {
    "0000000000000000f000000000000000": (
        "Standard",
        {"fileID": 46, "type": 0},
        {"_MainTex": "color", "_BumpMap": "normal", "_MetallicGlossMap": "mask", "_OcclusionMap": "mask"},
        {"_NORMALMAP", "_METALLICGLOSSMAP"},
    ),
    "933532a4fcc9baf4fa0491de14d08ed7": (
        "Universal Render Pipeline/Lit",
        {"fileID": 4800000, "type": 3},
        {
            "_BaseMap": "color",
            "_MainTex": "color",
            "_BumpMap": "normal",
            "_MetallicGlossMap": "mask",
            "_OcclusionMap": "mask",
        },
        {"_NORMALMAP", "_METALLICSPECGLOSSMAP", "_OCCLUSIONMAP"},
    ),
    "6e4ae4064600d784cac1e41a9e6f2e59": (
        "HDRP/Lit",
        {"fileID": 4800000, "type": 3},
        {"_BaseColorMap": "color", "_NormalMap": "normal", "_MaskMap": "mask"},
        {"_NORMALMAP", "_NORMALMAP_TANGENT_SPACE", "_MASKMAP"},
    ),
}


def is_number(value):
    return isinstance(value, int | float) and not isinstance(value, bool)


def is_reference(value):
    return isinstance(value, dict) and isinstance(value.get("fileID"), int)


PREDICATES = {
    REFERENCE: is_reference,
    FLAG: lambda value: is_number(value) and value in (0, 1),
    INTEGER: lambda value: is_number(value) and value == int(value),
    NUMBER: is_number,
    TEXT: lambda value: isinstance(value, str | int),
    LIST: lambda value: isinstance(value, list),
}


def check(value, kind, where):
    """Holds a value to a kind of the tables above; fields beyond those are Unity's own business."""
    if kind is None:
        return
    if isinstance(kind, dict):
        require(isinstance(value, dict), f"{where} is no table")
        for name, part in kind.items():
            require(name in value, f"{where} has no {name}")
            check(value[name], part, f"{where}.{name}")
    elif isinstance(kind, list):
        require(isinstance(value, list), f"{where} is no list")
        for number, part in enumerate(value):
            check(part, kind[0], f"{where}[{number}]")
    else:
        require(PREDICATES[kind](value), f"{where} is no {kind}: {value!r}")
