<?xml version="1.0" encoding="UTF-8"?>
<project xmlns="http://grogra.de/registry" graph="graph.xml">
 <import plugin="de.grogra.vecmath" version="1.5"/>
 <import plugin="de.grogra.imp3d" version="1.5"/>
 <import plugin="de.grogra.math" version="1.5"/>
 <import plugin="de.grogra.rgg" version="1.5"/>
 <import plugin="de.grogra.pf" version="1.5"/>
 <import plugin="de.grogra.imp" version="1.5"/>
 <registry>
  <ref name="project">
   <ref name="objects">
    <ref name="files">
     <de.grogra.pf.ui.registry.SourceFile mimeType="text/x-grogra-rgg" name="pfs:plant.rgg"/>
    </ref>
    <ref name="images">
     <de.grogra.pf.ui.registry.FileObjectItem mimeType="image/png" name="leaf" objDescribes="true" systemId="pfs:images/leaf.png" type="de.grogra.imp.objects.FixedImageAdapter"/>
    </ref>
    <ref name="meta">
     <de.grogra.pf.registry.NodeReference name="plant" ref="8"/>
    </ref>
    <ref name="3d">
     <ref name="shaders">
      <de.grogra.pf.registry.SONodeReference name="Leaf" objDescribes="true" ref="2"/>
      <de.grogra.pf.registry.SONodeReference name="Stem" objDescribes="true" ref="6"/>
     </ref>
    </ref>
   </ref>
  </ref>
  <ref name="workbench">
   <ref name="state">
    <de.grogra.pf.ui.registry.Layout name="layout">
     <de.grogra.pf.ui.registry.MainWindow>
      <de.grogra.pf.ui.registry.PanelFactory source="/ui/panels/3d/defaultview">
       <de.grogra.pf.registry.Option name="panelId" type="java.lang.String" value="/ui/panels/3d/defaultview"/>
       <de.grogra.pf.registry.Option name="panelTitle" type="java.lang.String" value="View"/>
       <de.grogra.pf.registry.Option name="view" type="de.grogra.imp3d.View3D" value="graphDescriptor=[de.grogra.imp.ProjectGraphDescriptor]visibleLayers={true true true true true true true true true true true true true true true true}epsilon=1.0E-6 visualEpsilon=0.01 magnitude=1.0 camera=(minZ=0.1 maxZ=2000.0 projection=[de.grogra.imp3d.PerspectiveProjection aspect=1.0 fieldOfView=0.418879]transformation=(0.78450012 0.620128666 0.0 -0.015690002 -0.22831338 0.28883018 0.929758102 -0.172087772 0.576569651 -0.729395342 0.368170982 -1.52103242 0.0 0.0 0.0 1.0))navigator=null"/>
      </de.grogra.pf.ui.registry.PanelFactory>
     </de.grogra.pf.ui.registry.MainWindow>
    </de.grogra.pf.ui.registry.Layout>
   </ref>
  </ref>
 </registry>
</project>
